"""The offline reader's data: a word list and small classifiers, stored as YAML and plain arrays.

A concept is read by a projection of each argument's crops onto principal components of its type, followed by a
two-layer network per concept and type signature. Nothing here is executed from the files, and nothing is unpickled.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Literal

import numpy as np
import yaml
from numpy.typing import NDArray
from pydantic import Field

from pix2pred.structs import Picture
from pix2pred.structs.formats.documents import Document
from pix2pred.vlm.offline.fine_sight import FineScene
from pix2pred.vlm.offline.inner_sight import InnerScene
from pix2pred.vlm.offline.line_sight import LineScene
from pix2pred.vlm.offline.pixels import MEASURES, Scene, Vector

Array = NDArray[np.float32]

WORDS, WEIGHTS = "words.yaml", "weights.npz"
"""The files of a reader's folder."""


_MOST_SURE = 8.0
"""The most that one picture's logarithm of odds counts when several pictures are read together.

With 4, two flat views of a table outvote the one from above in one case of fifty (48 states of Cleanup); with 6 to 12
in none.
"""


class WordDoc(Document):
    """A word the reader knows. Either it reads a ``concept`` (or its negation) with a trained classifier, or it is a
    distractor that compares a ``measure`` with a threshold."""

    word: str
    types: tuple[tuple[str, ...], ...] = Field(description="argument type signatures; names of kinds stand for all")
    concept: str | None = None
    negated: bool = False
    measure: str | None = None
    above: float = 0.0


class WordListDoc(Document):
    """The file ``words.yaml``."""

    format: Literal["pix2pred-reader"]
    version: Literal[1]
    sure: float = Field(0.6, ge=0.5, lt=1, description="below this probability the answer is Unknown")
    kinds: dict[str, tuple[str, ...]] = Field(default_factory=dict, description="names for several types")
    neighbours: tuple[str, ...] = Field(
        (), description="types whose nearest objects are looked at, with the finer sight; by default the simple one"
    )
    inner: bool = Field(False, description="the finer sight also looks at what is in vessels")
    drawn_on: tuple[str, ...] = Field((), description="types on which the finer sight also looks for drawn lines")
    decisive: tuple[str, ...] = Field((), description="cameras that, where one shows the objects, are read alone")
    words: tuple[WordDoc, ...]

    def scene(self, picture: Picture, types: Mapping[str, str]) -> Scene:
        """What is computed from a picture whose objects have ``types``, with the sight this reader was trained for."""
        if not self.neighbours:
            return Scene(picture)
        if self.drawn_on:
            return LineScene(picture, types=types, kinds=self.neighbours, drawn_on=self.drawn_on)
        return (InnerScene if self.inner else FineScene)(picture, types=types, kinds=self.neighbours)

    def uses(self) -> list[tuple[WordDoc, tuple[str, ...]]]:
        """Every word with every signature of plain types it applies to."""
        return [
            (word, types)
            for word in self.words
            for signature in word.types
            for types in product(*(self.kinds.get(t, (t,)) for t in signature))
        ]


def load_words(directory: Path) -> WordListDoc:
    """The word list in a reader's folder."""
    return WordListDoc.model_validate(yaml.safe_load((directory / WORDS).read_text(encoding="utf-8")))


@dataclass(frozen=True, slots=True)
class Projection:
    """Principal components of a type's crops."""

    mean: Array
    components: Array

    def __call__(self, crops: Vector) -> Vector:
        """The codes of one object, or of a batch of them."""
        return ((crops - self.mean) @ self.components.T).astype(np.float32)


@dataclass(frozen=True, slots=True)
class Classifier:
    """One hidden layer with ReLU, one logistic output; inputs are standardised first."""

    mean: Array
    scale: Array
    w1: Array
    b1: Array
    w2: Array
    b2: Array

    def probability(self, inputs: Vector) -> float:
        """How likely the concept is true."""
        hidden = np.maximum((inputs - self.mean) / self.scale @ self.w1 + self.b1, 0)
        return float(1 / (1 + np.exp(-np.minimum(np.maximum(hidden @ self.w2 + self.b2, -30), 30)).item()))


def inputs(scene: Scene, projections: Mapping[str, Projection], names: Sequence[str], types: Sequence[str]) -> Vector:
    """What a classifier sees of objects that all have usable crops. The scene keeps it: many words ask about them."""
    key = (*names, *types)
    if key not in scene.sights and len(names) == 1:
        crops = scene.crops(names[0])
        assert crops is not None, f"{names[0]} has no crops"
        scene.sights[key] = np.concatenate([projections[types[0]](crops), scene.surroundings(names[0])])
    elif key not in scene.sights:
        parts = [inputs(scene, projections, [name], [kind]) for name, kind in zip(names, types, strict=True)]
        scene.sights[key] = np.concatenate([*parts, scene.relation(*names)] if len(names) == 2 else parts)
    return scene.sights[key]


class ReaderModel:
    """Word list, projections and classifiers of one domain."""

    def __init__(
        self,
        words: WordListDoc,
        projections: Mapping[str, Projection],
        classifiers: Mapping[tuple[str, ...], Classifier],
        digest: str,
    ) -> None:
        self.words = words
        self.digest = digest
        self._projections = projections
        self._classifiers = classifiers
        self._by_use = {(w.word, types): w for w, types in words.uses()}

    @classmethod
    def load(cls, directory: Path) -> ReaderModel:
        """Read ``words.yaml`` and ``weights.npz`` from ``directory``."""
        text = (directory / WORDS).read_bytes()
        weights = (directory / WEIGHTS).read_bytes()
        with np.load(directory / WEIGHTS, allow_pickle=False) as arrays:
            table = {key: arrays[key].astype(np.float32) for key in arrays.files}
        projections, classifiers = unpack(table)
        return cls(load_words(directory), projections, classifiers, hashlib.sha256(text + weights).hexdigest())

    def value(self, word: str, names: Sequence[str], types: Sequence[str], scene: Scene) -> tuple[bool | None, float]:
        """(value or None for unknown, probability of True) of a word about objects in a picture."""
        use = self._by_use.get((word, tuple(types)))
        if use is None or any(scene.crops(name) is None for name in names):
            return None, 0.5
        if use.measure is not None:
            measured = MEASURES[use.measure](scene, *names)
            return (None, 0.5) if measured is None else (measured > use.above, 1.0 if measured > use.above else 0.0)
        classifier = self._classifiers[(str(use.concept), *types)]
        p = classifier.probability(inputs(scene, self._projections, names, types))
        if use.negated:
            p = 1 - p
        sure = self.words.sure
        return (True if p >= sure else False if p <= 1 - sure else None), p

    def joint_value(
        self, word: str, names: Sequence[str], types: Sequence[str], scenes: Sequence[Scene]
    ) -> tuple[bool | None, float]:
        """The value read from all pictures of a state that show the objects; ``None`` when no picture does.

        The surest picture decides; with the finer sight all have a say, because one that shows only a part of an
        object may be sure and wrong. Where a decisive camera shows the objects, the others are not read: from below the
        side of a vessel is seen, and not what is in it.
        """
        scenes = [s for s in scenes if s.picture.camera in self.words.decisive] or scenes
        readings = [self.value(word, names, types, scene) for scene in scenes]
        if not self.words.neighbours or len(readings) < 2:
            return max(readings, key=lambda read: abs(read[1] - 0.5), default=(None, 0.5))
        votes = [np.clip(np.log(p / (1 - p)), -_MOST_SURE, _MOST_SURE) for _, p in readings if 0 < p < 1]
        p = float(1 / (1 + np.exp(-np.sum(votes)))) if votes else readings[0][1]
        sure = self.words.sure
        return (True if p >= sure else False if p <= 1 - sure else None), p


def unpack(table: Mapping[str, Array]) -> tuple[dict[str, Projection], dict[tuple[str, ...], Classifier]]:
    """Arrays named ``projection|type|part`` and ``classifier|concept|types...|part`` as objects."""
    projections: dict[str, Projection] = {}
    classifiers: dict[tuple[str, ...], Classifier] = {}
    for key in table:
        kind, *name, part = key.split("|")
        if part != "mean":
            continue

        def array(field: str, prefix: str = key.removesuffix("mean")) -> Array:
            return table[prefix + field]

        if kind == "projection":
            projections[name[0]] = Projection(array("mean"), array("components"))
        else:
            parts = ("mean", "scale", "w1", "b1", "w2", "b2")
            classifiers[tuple(name)] = Classifier(*(array(p) for p in parts))
    return projections, classifiers
