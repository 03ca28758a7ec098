"""The reader itself: what it read of every atom of a look, how sure it is, and why it does not know."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from pix2pred.vlm.distilled.calibration import Calibration
from pix2pred.vlm.distilled.codes import RegionCode
from pix2pred.vlm.distilled.looks import Look
from pix2pred.vlm.distilled.machine import Layout, WordMachine, squared_distances
from pix2pred.vlm.distilled.regions import Kinds, Names, PictureSeen, kinds_of_regions, regions_of
from pix2pred.vlm.distilled.sight import Array

AtomAsked = tuple[str, Names]
"""A word and the names of its objects, as in a prompt."""


class Why(StrEnum):
    """What a reading rests on, or why there is none."""

    READ = "read"
    UNSURE = "not sure"
    STRANGE = "looks like nothing seen before"
    """The objects are further from all that was seen in training
    than the bar allows, whatever the score."""
    BLANK = "nothing to see in its box"
    UNSEEN = "no picture shows it"
    UNTAUGHT = "was not taught"


@dataclass(frozen=True, slots=True)
class Reading:
    """``value`` is ``None`` when the reader does not know; ``probability`` is that of true, as far as it can tell."""

    value: bool | None
    probability: float
    why: Why


@dataclass(frozen=True, slots=True)
class Bars:
    """When a reader says that it knows: ``sure`` is the least probability, ``strange`` the most strangeness.

    Strangeness is measured by what demonstrations that were left out needed: 1 is the most that is usual.
    """

    sure: float
    strange: float


@dataclass(frozen=True, slots=True)
class Taught:
    """One word about objects of certain kinds.

    ``machine`` gives it a score, which ``calibration`` makes a probability.
    """

    machine: WordMachine
    calibration: Calibration


@dataclass(frozen=True, slots=True)
class KindsModel:
    """All words about objects of the same kinds. ``rows`` are the codes of what was seen in training.

    ``relation`` holds mean and deviation of how the objects lie, of shape (2, numbers); ``nearest`` is the largest
    usual distance (squared) of a new row from all rows.
    """

    layout: Layout
    rows: Array
    relation: Array
    nearest: float
    words: Mapping[str, Taught]


@dataclass(frozen=True, slots=True)
class View:
    """What one picture says about an atom.

    ``score`` is that of its word, about -1 for false and 1 for true; ``strange`` tells how unlike the training its
    objects look there.
    """

    score: float
    strange: float


@dataclass(frozen=True, slots=True)
class DistilledModel:
    """Reads looks. ``regions`` are the codes of every kind of region, ``kinds`` the words by kinds of objects."""

    regions: Mapping[str, RegionCode]
    kinds: Mapping[Kinds, KindsModel]
    bars: Bars

    @property
    def words(self) -> list[tuple[str, Kinds]]:
        """Every word with the kinds of objects it was taught about, sorted."""
        return sorted((word, kinds) for kinds, model in self.kinds.items() for word in model.words)

    def read(self, look: Look, atoms: Sequence[AtomAsked]) -> list[Reading]:
        """A reading for each atom, from all pictures of the look that show its objects."""
        views: defaultdict[AtomAsked, list[View]] = defaultdict(list)
        why: dict[AtomAsked, Why] = dict.fromkeys(atoms, Why.UNSEEN)
        taught: dict[AtomAsked, Taught] = {}
        for picture in look.pictures:
            seen = PictureSeen(look, picture)
            asked: defaultdict[Kinds, list[AtomAsked]] = defaultdict(list)
            for atom in dict.fromkeys(atoms):
                kinds = seen.kinds(atom[1])
                if kinds is None:
                    continue
                model = self.kinds.get(kinds)
                if model is None or atom[0] not in model.words:
                    why[atom] = Why.UNTAUGHT
                elif not seen.shows(atom[1]):
                    why[atom] = Why.BLANK
                else:
                    taught[atom] = model.words[atom[0]]
                    asked[kinds].append(atom)
            for kinds, group in asked.items():
                for atom, view in zip(group, self._views(seen, kinds, group), strict=True):
                    views[atom].append(view)
        return [
            self._reading(taught[atom], views[atom]) if views[atom] else Reading(None, 0.5, why[atom]) for atom in atoms
        ]

    def _views(self, seen: PictureSeen, kinds: Kinds, atoms: Sequence[AtomAsked]) -> list[View]:
        model = self.kinds[kinds]
        tuples = list(dict.fromkeys(names for _, names in atoms))
        codes, strange = self.codes(seen, kinds, tuples)
        columns = list(range(codes.shape[1]))
        nearest = squared_distances(model.layout, columns, codes, model.rows).min(axis=1) / np.float32(model.nearest)
        strange = np.maximum(strange, np.sqrt(nearest))
        place = {names: i for i, names in enumerate(tuples)}
        scores: dict[AtomAsked, float] = {}
        for word in dict.fromkeys(word for word, _ in atoms):
            mine = [names for w, names in atoms if w == word]
            found = model.words[word].machine.scores(model.layout, codes[[place[n] for n in mine]], model.rows)
            scores |= {(word, names): float(s) for names, s in zip(mine, found, strict=True)}
        return [View(scores[atom], float(strange[place[atom[1]]])) for atom in atoms]

    def codes(self, seen: PictureSeen, kinds: Kinds, tuples: Sequence[Names]) -> tuple[Array, Array]:
        """Codes of tuples of objects of ``kinds``, and how strange their regions look."""
        regions = [regions_of(names) for names in tuples]
        vectors = seen.vectors([r for parts in regions for r in parts])
        vectors = vectors.reshape(len(tuples), -1, vectors.shape[1])
        coded = [self.regions[kind](vectors[:, i]) for i, kind in enumerate(kinds_of_regions(kinds))]
        relations = np.stack([seen.relation(names) for names in tuples])
        mean, deviation = self.kinds[kinds].relation
        parts = [part for c in coded for part in c.parts.values()]
        codes = np.concatenate([*parts, (relations - mean) / deviation], axis=1, dtype=np.float32)
        return codes, np.max([c.strange for c in coded], axis=0)

    def _reading(self, taught: Taught, views: Sequence[View]) -> Reading:
        known = [view for view in views if view.strange <= self.bars.strange]
        if not known:
            return Reading(None, 0.5, Why.STRANGE)
        p = taught.calibration.probability(joint([view.score for view in known]))
        if max(p, 1 - p) < self.bars.sure:
            return Reading(None, p, Why.UNSURE)
        return Reading(p > 0.5, p, Why.READ)


def joint(scores: Sequence[float]) -> float:
    """One score of several pictures: their mean, in which the surer ones count for more."""
    total = sum(abs(s) for s in scores)
    return sum(s * abs(s) for s in scores) / total if total else 0.0
