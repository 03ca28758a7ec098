"""The reader itself: what it read of every atom of a look, how sure it is, and why it does not know."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from pix2pred.vlm.distilled.calibration import Calibration
from pix2pred.vlm.distilled.codes import RegionCode
from pix2pred.vlm.distilled.machine import Compared, Rows, WordMachine
from pix2pred.vlm.distilled.regions import PICTURE, Kinds, Names, PictureSeen, kinds_of_regions, regions_of
from pix2pred.vlm.distilled.sight import Array
from pix2pred.vlm.offline.label_question import Look

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
class AtomReading:
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
class ByName:
    """What an object's name tells about a word that does not change: ``values``, right with ``probability``."""

    values: Mapping[str, bool]
    probability: float

    def odds(self, names: Names) -> float:
        """Log odds of true; 0 for names of which nothing is known."""
        value = self.values.get(names[0]) if len(names) == 1 else None
        if value is None:
            return 0.0
        odds = math.log(self.probability / (1 - self.probability))
        return odds if value else -odds


BY_NO_NAME = ByName({}, 0.5)


@dataclass(frozen=True, slots=True)
class WordReader:
    """One word about objects of certain kinds.

    ``machine`` gives it a score, which ``calibration`` makes a probability; ``by_name`` has a say in words that do not
    change.
    """

    machine: WordMachine
    calibration: Calibration
    by_name: ByName = BY_NO_NAME

    def probability(self, score: float, names: Names) -> float:
        """The probability of true, by what is seen and by the object's name: their log odds are added."""
        seen, odds = self.calibration.probability(score), self.by_name.odds(names)
        return seen / (seen + (1 - seen) * math.exp(-odds)) if odds else seen


@dataclass(frozen=True, slots=True)
class KindsModel:
    """All words about objects of the same kinds. ``rows`` are the codes of what was seen in training.

    ``relation`` holds mean and deviation of how the objects lie, of shape (2, numbers); ``nearest`` is the largest
    usual distance (squared) of a new row from all rows.
    """

    rows: Rows
    relation: Array
    nearest: float
    words: Mapping[str, WordReader]


@dataclass(frozen=True, slots=True)
class PictureScore:
    """What one picture says about an atom.

    ``score`` is that of its word, about -1 for false and 1 for true; ``strange`` tells how unlike the training its
    objects look there.
    """

    score: float
    strange: float


@dataclass(frozen=True, slots=True)
class DistilledModel:
    """Reads looks. ``regions`` are the codes of every kind of region, ``kinds`` the words by kinds of objects.

    ``company`` are the types of objects that are looked for about an object.
    """

    regions: Mapping[str, RegionCode]
    kinds: Mapping[Kinds, KindsModel]
    bars: Bars
    company: tuple[str, ...] = ()

    @property
    def words(self) -> list[tuple[str, Kinds]]:
        """Every word with the kinds of objects it was taught about, sorted."""
        return sorted((word, kinds) for kinds, model in self.kinds.items() for word in model.words)

    def read(self, look: Look, atoms: Sequence[AtomAsked]) -> list[AtomReading]:
        """A reading for each atom, from all pictures of the look that show its objects."""
        views: defaultdict[AtomAsked, list[PictureScore]] = defaultdict(list)
        why: dict[AtomAsked, Why] = dict.fromkeys(atoms, Why.UNSEEN)
        taught: dict[AtomAsked, WordReader] = {}
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
            for atom, view in self._views(seen, asked) if asked else ():
                views[atom].append(view)
        return [
            self._reading(taught[atom], atom[1], views[atom]) if views[atom] else AtomReading(None, 0.5, why[atom])
            for atom in atoms
        ]

    def _views(
        self, seen: PictureSeen, asked: Mapping[Kinds, Sequence[AtomAsked]]
    ) -> Iterator[tuple[AtomAsked, PictureScore]]:
        """What a picture says about atoms; each of their regions is looked at once."""
        tuples = {kinds: list(dict.fromkeys(names for _, names in atoms)) for kinds, atoms in asked.items()}
        coded, scene = self._coded(seen, tuples), self._scene(seen)
        for kinds, atoms in asked.items():
            model = self.kinds[kinds]
            parts = [[coded[part] for part in _regions(kinds, names)] for names in tuples[kinds]]
            mean, deviation = model.relation
            relations = [(seen.relation(names, self.company) - mean) / deviation for names in tuples[kinds]]
            codes = np.stack([
                np.concatenate([*(code for code, _ in row), relation], dtype=np.float32)
                for row, relation in zip(parts, relations, strict=True)
            ])  # fmt: skip
            compared = Compared(codes, model.rows)
            nearest = compared.squared(model.rows.layout.own).min(axis=1) / np.float32(model.nearest)
            strange = np.maximum(np.sqrt(nearest), [max(scene, *(strange for _, strange in row)) for row in parts])
            place = {names: i for i, names in enumerate(tuples[kinds])}
            scores = {word: model.words[word].machine.scores(compared) for word in dict.fromkeys(w for w, _ in atoms)}
            for word, names in atoms:
                yield (word, names), PictureScore(float(scores[word][place[names]]), float(strange[place[names]]))

    def _scene(self, seen: PictureSeen) -> float:
        """How strange the picture looks as a whole; readers made before this was asked take every picture."""
        whole = self.regions.get(PICTURE)
        return 0.0 if whole is None else float(whole(seen.vectors([()])).strange[0])

    def _coded(
        self, seen: PictureSeen, tuples: Mapping[Kinds, Sequence[Names]]
    ) -> dict[tuple[str, Names], tuple[Array, float]]:
        """By kind and names of a region its code, and how strange it looks."""
        found: dict[tuple[str, Names], tuple[Array, float]] = {}
        regions = dict.fromkeys(
            region for kinds, group in tuples.items() for names in group for region in _regions(kinds, names)
        )
        vectors = seen.vectors([names for _, names in regions])
        for kind in dict.fromkeys(kind for kind, _ in regions):
            mine = [i for i, (k, _) in enumerate(regions) if k == kind]
            coded = self.regions[kind](vectors[mine])
            codes = np.concatenate(list(coded.parts.values()), axis=1)
            for region, code, strange in zip(
                [r for r in regions if r[0] == kind], codes, coded.strange.tolist(), strict=True
            ):
                found[region] = (code, strange)
        return found

    def _reading(self, taught: WordReader, names: Names, views: Sequence[PictureScore]) -> AtomReading:
        known = [view for view in views if view.strange <= self.bars.strange]
        if not known:
            return AtomReading(None, 0.5, Why.STRANGE)
        p = taught.probability(joint([view.score for view in known]), names)
        if max(p, 1 - p) < self.bars.sure:
            return AtomReading(None, p, Why.UNSURE)
        return AtomReading(p > 0.5, p, Why.READ)


def _regions(kinds: Kinds, names: Names) -> list[tuple[str, Names]]:
    return list(zip(kinds_of_regions(kinds), regions_of(names), strict=True))


def joint(scores: Sequence[float]) -> float:
    """One score of several pictures: their mean, in which the surer ones count for more."""
    total = sum(abs(s) for s in scores)
    return sum(s * abs(s) for s in scores) / total if total else 0.0
