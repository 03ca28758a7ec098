"""From labelled looks to vectors: which atoms can be seen, which are kept, and what is seen of them."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from pix2pred.vlm.distilled.fitting.lesson import FitSettings, Lesson
from pix2pred.vlm.distilled.regions import PICTURE, Kinds, Names, PictureSeen, kinds_of_regions, regions_of
from pix2pred.vlm.distilled.sight import UNCHANGED, Array, Augmentation

MOVED, SCALED, BRIGHTER, CONTRASTED = 0.03, 0.05, 0.04, 0.06
"""Deviations of the changes: shares of the box's side, and of the range of brightness. Nothing is mirrored or turned:
words such as left, above and open would change their meaning."""

NUMBERS_PER_ROW = 210
"""Codes of a row about two objects, for sharing out the memory among kinds of objects."""


@dataclass(frozen=True, slots=True)
class ShownObjects:
    """Objects in one picture of a look.

    ``look`` and ``picture`` are numbers.
    """

    look: int
    picture: int
    names: Names


@dataclass(slots=True)
class RowsOfKinds:
    """The rows of one kind of objects, and the labels of every word there, with their weights."""

    rows: dict[ShownObjects, None] = field(default_factory=dict)
    labels: defaultdict[str, dict[ShownObjects, tuple[bool, float]]] = field(default_factory=lambda: defaultdict(dict))


@dataclass(frozen=True, slots=True)
class SeenRegions:
    """What was seen: vectors by kind of region, the group of each, and where the regions of every row are.

    ``places[kinds][c][r][i]`` is the index, among the vectors of the i-th kind of region, of copy ``c`` of row ``r``.
    ``company`` are the types of all objects that have boxes.
    """

    vectors: dict[str, Array]
    groups: dict[str, NDArray[np.int64]]
    places: dict[Kinds, NDArray[np.int64]]
    relations: dict[Kinds, Array]
    company: tuple[str, ...]


def rows_by_kinds(lesson: Lesson) -> dict[Kinds, RowsOfKinds]:
    """The rows in which labelled atoms can be seen, by the kinds of their objects."""
    by_look: defaultdict[int, list[int]] = defaultdict(list)
    for i, example in enumerate(lesson.examples):
        by_look[example.look].append(i)
    found: defaultdict[Kinds, RowsOfKinds] = defaultdict(RowsOfKinds)
    for number, indices in sorted(by_look.items()):
        look = lesson.looks[number]
        for p, picture in enumerate(look.pictures):
            seen = PictureSeen(look, picture)
            for i in indices:
                example = lesson.examples[i]
                kinds = seen.kinds(example.names)
                if kinds is None or not seen.shows(example.names):
                    continue
                row, group = ShownObjects(number, p, example.names), found[kinds]
                group.rows.setdefault(row)
                group.labels[example.word][row] = (example.label, example.weight)
    return dict(sorted(found.items()))


def thinned(found: dict[Kinds, RowsOfKinds], settings: FitSettings) -> dict[Kinds, RowsOfKinds]:
    """At most so many rows of each kind that all fit; labels of which there are few are kept first."""
    most = int(settings.megabytes * 1e6 / (2 * NUMBERS_PER_ROW * (1 + settings.copies)))
    each = min(settings.most_rows, max(20, most // max(1, len(found))))
    spare = most - sum(min(each, len(group.rows)) for group in found.values())
    large = sum(len(group.rows) > each for group in found.values())
    each = min(settings.most_rows, each + max(0, spare) // max(1, large))
    rng = np.random.default_rng(settings.seed)
    return {kinds: _thinned(group, each, rng) for kinds, group in found.items()}


def _thinned(group: RowsOfKinds, most: int, rng: np.random.Generator) -> RowsOfKinds:
    if len(group.rows) <= most:
        return group
    rare = set[ShownObjects]()
    for labels in group.labels.values():
        counts = Counter(label for label, _ in labels.values())
        value = counts[True] <= counts[False]
        rare |= {row for row, (label, _) in labels.items() if label == value}
    rows = list(group.rows)
    order = [rows[i] for i in rng.permutation(len(rows))]
    first = [row for row in order if row in rare][: most // 2]
    chosen = set(first)
    chosen |= set([row for row in order if row not in chosen][: most - len(first)])
    thin: defaultdict[str, dict[ShownObjects, tuple[bool, float]]] = defaultdict(dict)
    for word, by_row in group.labels.items():
        thin[word] = {row: value for row, value in by_row.items() if row in chosen}
    return RowsOfKinds(dict.fromkeys(row for row in rows if row in chosen), thin)


def see_rows(lesson: Lesson, found: dict[Kinds, RowsOfKinds], settings: FitSettings) -> SeenRegions:
    """Look at all rows, as they are and through changes that keep what they show."""
    copies, company = 1 + settings.copies, _types_with_boxes(lesson)
    wanted: defaultdict[tuple[int, int], list[tuple[Kinds, int]]] = defaultdict(list)
    for kinds, group in found.items():
        for r, row in enumerate(group.rows):
            wanted[row.look, row.picture].append((kinds, r))
    places = {
        kinds: np.zeros((copies, len(group.rows), len(kinds_of_regions(kinds))), dtype=np.int64)
        for kinds, group in found.items()
    }
    rows = {kinds: list(group.rows) for kinds, group in found.items()}
    relations: dict[Kinds, list[Array]] = {
        kinds: [np.zeros(0, dtype=np.float32)] * len(group.rows) for kinds, group in found.items()
    }
    vectors: defaultdict[str, list[Array]] = defaultdict(list)
    groups: defaultdict[str, list[int]] = defaultdict(list)
    names_of_groups = sorted(set(lesson.groups))
    rng = np.random.default_rng([settings.seed, 1])
    for (number, p), members in sorted(wanted.items()):
        seen = PictureSeen(lesson.looks[number], lesson.looks[number].pictures[p])
        regions: dict[tuple[str, Names], int] = {(PICTURE, ()): 0}
        for kinds, r in members:
            names = rows[kinds][r].names
            relations[kinds][r] = seen.relation(names, company)
            for kind, region in zip(kinds_of_regions(kinds), regions_of(names), strict=True):
                regions.setdefault((kind, region), len(regions))
        for c in range(copies):
            change = drawn(rng) if c else UNCHANGED
            new = seen.vectors([region for _, region in regions], change).astype(np.float16)
            index = {}
            for (kind, region), vector in zip(regions, new, strict=True):
                if kind == PICTURE and c:
                    continue  # a picture that is moved shows its edge
                index[kind, region] = len(vectors[kind])
                vectors[kind].append(vector)
                groups[kind].append(names_of_groups.index(lesson.groups[number]))
            for kinds, r in members:
                parts = zip(kinds_of_regions(kinds), regions_of(rows[kinds][r].names), strict=True)
                places[kinds][c, r] = [index[part] for part in parts]
    return SeenRegions(
        {kind: np.stack(rows) for kind, rows in sorted(vectors.items())},
        {kind: np.array(numbers) for kind, numbers in sorted(groups.items())},
        places,
        {kinds: np.stack(rows) for kinds, rows in relations.items()},
        company,
    )


def _types_with_boxes(lesson: Lesson) -> tuple[str, ...]:
    pictures = ((look, picture) for look in lesson.looks for picture in look.pictures)
    return tuple(sorted({look.types[n] for look, picture in pictures for n in picture.boxes if n in look.types}))


def drawn(rng: np.random.Generator) -> Augmentation:
    """A change drawn by chance."""
    dx, dy, scale, brightness, contrast = rng.normal(size=5)
    return Augmentation(MOVED * dx, MOVED * dy, 1 + SCALED * scale, BRIGHTER * brightness, 1 + CONTRASTED * contrast)


def folds_of(groups: Sequence[str], most: int) -> dict[str, int]:
    """A fold for every group: as many folds as groups, or ``most``, the larger groups spread over all."""
    sizes = Counter(groups)
    load = [0] * min(most, len(sizes))
    fold: dict[str, int] = {}
    for group in sorted(sizes, key=lambda g: (-sizes[g], g)):
        fold[group] = min(range(len(load)), key=lambda f: (load[f], f))
        load[fold[group]] += sizes[group]
    return fold
