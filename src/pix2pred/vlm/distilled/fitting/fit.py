"""Making a reader of a lesson: components, codes, words and bars, and how good it is on demonstrations left out."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from threadpoolctl import threadpool_limits

from pix2pred.system.progress import Progress, Stage, silent
from pix2pred.vlm.distilled.codes import RegionCode
from pix2pred.vlm.distilled.fitting.components import picture_code, region_code, spreads_in_kernel
from pix2pred.vlm.distilled.fitting.lesson import FitSettings, Lesson, LessonError
from pix2pred.vlm.distilled.fitting.naming import by_name
from pix2pred.vlm.distilled.fitting.rows import (
    RowsOfKinds,
    SeenRegions,
    ShownObjects,
    folds_of,
    rows_by_kinds,
    see_rows,
    thinned,
)
from pix2pred.vlm.distilled.fitting.teaching import Ints, TaughtWord, WordRows, teach
from pix2pred.vlm.distilled.machine import COMPANY, Compared, Layout, Rows
from pix2pred.vlm.distilled.model import Bars, DistilledModel, KindsModel, WordReader
from pix2pred.vlm.distilled.regions import PICTURE, Kinds, kinds_of_regions
from pix2pred.vlm.distilled.sight import Array

USUAL_NEAREST = 0.98
"""The share of rows of demonstrations left out whose distance from the others is at most the usual one."""
USUAL_CHANGE = 0.75
"""The share of changed copies whose distance from what they are made of is at most the usual one: what does not matter
makes nothing strange, however often episodes repeat the same looks and make all distances small. On seed 11 of
More-stacks and Kitchen more than this added nothing."""
_LEAST_NEAREST = 1e-2
ALIKE = 0.1
"""How far a second look at the same objects with the same label, in the same demonstration, repeats the first."""


@dataclass(frozen=True, slots=True)
class WordResult:
    """How a word did on demonstrations left out: units seen, true ones, answered, and answers as the teacher's.

    ``teacher_error`` is the share of the teacher's labels that the reader takes to be wrong.
    """

    word: str
    kinds: Kinds
    seen: int
    true: int
    answered: int
    right: int
    teacher_error: float


@dataclass(frozen=True, slots=True)
class Untaught:
    """A word about objects of ``kinds`` that could not be taught.

    ``reason`` says why, in words for people.
    """

    word: str
    kinds: Kinds
    reason: str


@dataclass(frozen=True, slots=True)
class Fitted:
    """What fitting gives: a reader, as a ``model`` without its files.

    ``results`` say how each word did on what was left out; ``untaught`` are the words it has no answer to.
    """

    model: DistilledModel
    results: tuple[WordResult, ...]
    untaught: tuple[Untaught, ...]


def fit(lesson: Lesson, settings: FitSettings, progress: Progress = silent) -> Fitted:
    """A reader of what ``lesson`` shows. Raises ``LessonError`` when there is nothing that can be learned.

    Linear algebra runs on one core, because its results depend on how many share the work.
    """
    with threadpool_limits(limits=1):
        return _fit(lesson, settings, progress)


def _fit(lesson: Lesson, settings: FitSettings, progress: Progress) -> Fitted:
    if len(set(lesson.groups)) < 2:
        raise LessonError(
            f"labels of {len(set(lesson.groups))} demonstration cannot teach a reader: it must be measured on one that "
            "it has not seen. Add demonstrations, or episodes with --with"
        )
    found = rows_by_kinds(lesson)
    if not found:
        raise LessonError("none of the labelled atoms is about something that a picture shows; nothing can be learned")
    found, untaught = _teachable(lesson, found, settings)
    if not found:
        first = untaught[0]
        raise LessonError(
            f"nothing can be learned: {first.word} {first.reason}"
            + (f", and {len(untaught) - 1} others are no better" if len(untaught) > 1 else "")
        )
    names = {
        (kinds, word): by_name(lesson.groups, labels, settings.sure)
        for kinds, group in found.items()
        for word, labels in group.labels.items()
    }
    found = thinned(found, settings)
    seen = see_rows(lesson, found, settings)
    regions = {
        kind: (picture_code if kind == PICTURE else region_code)(vectors, seen.groups[kind])
        for kind, vectors in seen.vectors.items()
    }
    fold = folds_of([lesson.groups[row.look] for group in found.values() for row in group.rows], settings.folds)
    bars = Bars(settings.sure, settings.strange)
    kinds_models: dict[Kinds, KindsModel] = {}
    results: list[WordResult] = []
    count = sum(len(group.labels) for group in found.values())
    for kinds, group in found.items():
        progress(Stage.DISTIL, len(results), count, ", ".join(kinds))
        folds = np.array([fold[lesson.groups[row.look]] for row in group.rows])
        model, strange = _kinds_model(kinds, seen, regions, folds)
        taught = {
            word: _teach(model, group, _weighed(lesson, group, word), folds, settings) for word in sorted(group.labels)
        }
        kinds_models[kinds] = KindsModel(
            model.rows, model.relation, model.nearest,
            {word: WordReader(t.machine, t.calibration, names[kinds, word]) for word, t in taught.items()},
        )  # fmt: skip
        results += [_result(word, kinds, t, _by_unit(group, strange), bars) for word, t in taught.items()]
    progress(Stage.DISTIL, count, count, "")
    return Fitted(DistilledModel(regions, kinds_models, bars, seen.company), tuple(results), tuple(untaught))


def _teachable(
    lesson: Lesson, found: Mapping[Kinds, RowsOfKinds], settings: FitSettings
) -> tuple[dict[Kinds, RowsOfKinds], list[Untaught]]:
    """The words with enough examples of either value, and the others."""
    kept: dict[Kinds, RowsOfKinds] = {}
    untaught = []
    for kinds, group in found.items():
        labels: defaultdict[str, dict[ShownObjects, tuple[bool, float]]] = defaultdict(dict)
        for word, by_row in sorted(group.labels.items()):
            reason = _lacking(lesson, by_row, settings)
            if reason:
                untaught.append(Untaught(word, kinds, reason))
            else:
                labels[word] = by_row
        if labels:
            rows = dict.fromkeys(row for row in group.rows if any(row in by_row for by_row in labels.values()))
            kept[kinds] = RowsOfKinds(rows, labels)
    return kept, untaught


def _lacking(lesson: Lesson, labels: Mapping[ShownObjects, tuple[bool, float]], settings: FitSettings) -> str:
    """What a word lacks; empty when it can be taught."""
    for value in (True, False):
        groups = Counter(lesson.groups[row.look] for row, (label, _) in labels.items() if label == value)
        if not groups:
            return f"is labelled {not value} always, which shows no difference to learn"
        if groups.total() < settings.least or len(groups) < 2:
            many = f"{groups.total()} time{'s' if groups.total() > 1 else ''} in {len(groups)} demonstration"
            return f"is labelled {value} only {many}{'s' if len(groups) > 1 else ''}"
    return ""


def _kinds_model(
    kinds: Kinds, seen: SeenRegions, regions: Mapping[str, RegionCode], folds: Ints
) -> tuple[KindsModel, Array]:
    """Codes of all rows, copies after originals, and how strange each original is when its fold is left out."""
    places, relations = seen.places[kinds], seen.relations[kinds]
    copies, count = places.shape[:2]
    parts: dict[str, Array] = {}
    spreads: list[Array] = []
    strange = np.zeros(count, dtype=np.float32)
    for i, kind in enumerate(kinds_of_regions(kinds)):
        vectors = seen.vectors[kind][places[:, :, i].ravel()].astype(np.float32)
        coded = regions[kind](vectors)
        strange = np.maximum(strange, coded.strange[:count])
        parts |= {f"{i}.{name}": part for name, part in coded.parts.items()}
        spreads += spreads_in_kernel(list(regions[kind].parts.values()))
    mean, deviation = relations.mean(axis=0), np.maximum(relations.std(axis=0), 0.05)
    if relations.shape[1]:
        parts["layout" if len(kinds) > 1 else COMPANY] = np.tile((relations - mean) / deviation, (copies, 1))
        spreads.append(np.full(relations.shape[1], 1 / np.sqrt(relations.shape[1])))
    ends = np.cumsum([part.shape[1] for part in parts.values()])
    layout = Layout(
        {name: (int(end - part.shape[1]), int(end)) for (name, part), end in zip(parts.items(), ends, strict=True)},
        np.concatenate(spreads).astype(np.float32),
    )
    rows = np.concatenate(list(parts.values()), axis=1).astype(np.float16).astype(np.float32)
    nearest = _nearest(layout, rows, folds, copies)
    usual = max(_LEAST_NEAREST, float(np.quantile(nearest, USUAL_NEAREST)), _changed(layout, rows, count))
    strange = np.maximum(strange, np.sqrt(nearest / usual)).astype(np.float32)
    relation = np.stack([mean, deviation]) if relations.shape[1] else np.zeros((2, 0))
    return KindsModel(Rows(layout, rows), relation.astype(np.float32), usual, {}), strange


def _nearest(layout: Layout, rows: Array, folds: Ints, copies: int) -> Array:
    """Of every original row the squared distance to the nearest row of another fold."""
    count = len(folds)
    everywhere = np.tile(folds, copies)
    nearest = np.zeros(count, dtype=np.float32)
    for fold in np.unique(folds):
        out = np.flatnonzero(folds == fold)
        others = rows[everywhere != fold]
        if len(others):
            nearest[out] = Compared(rows[out], Rows(layout, others)).squared(layout.own).min(axis=1)
    return nearest


def _changed(layout: Layout, rows: Array, count: int) -> float:
    """The squared distance to which the usual changed copy of one of the first ``count`` rows lies from it."""
    originals, changed = rows[:count], rows[count:]
    if not len(changed):
        return 0.0
    moved = (changed - np.tile(originals, (len(changed) // count, 1))) ** 2 @ layout.mean_of(layout.own)
    return float(np.quantile(moved, USUAL_CHANGE))


def _weighed(lesson: Lesson, group: RowsOfKinds, word: str) -> dict[ShownObjects, tuple[bool, float]]:
    """The labels of a word; those that tell the same of the same objects in one demonstration count less each."""
    labels = group.labels[word]
    looks: defaultdict[tuple[str, tuple[str, ...], bool], set[int]] = defaultdict(set)
    for row, (label, _) in labels.items():
        looks[lesson.groups[row.look], row.names, label].add(row.look)
    return {
        row: (label, weight / (1 + ALIKE * (len(looks[lesson.groups[row.look], row.names, label]) - 1)))
        for row, (label, weight) in labels.items()
    }


def _teach(
    model: KindsModel,
    group: RowsOfKinds,
    labels: Mapping[ShownObjects, tuple[bool, float]],
    folds: Ints,
    settings: FitSettings,
) -> TaughtWord:
    rows = list(group.rows)
    indices = np.array([i for i, row in enumerate(rows) if row in labels])
    copies = len(model.rows.codes) // len(rows)
    unit = _units(rows)
    own = [labels[rows[i]] for i in indices]
    everywhere = np.concatenate([indices + c * len(rows) for c in range(copies)])
    mine = WordRows(
        everywhere,
        np.tile([label for label, _ in own], copies),
        np.tile([weight / copies for _, weight in own], copies),
        np.tile(folds[indices], copies),
        np.tile([unit[rows[i].look, rows[i].names] for i in indices], copies),
        everywhere < len(rows),
    )
    return teach(model.rows, mine, np.random.default_rng([settings.seed, 2]))


def _units(rows: Sequence[ShownObjects]) -> dict[tuple[int, tuple[str, ...]], int]:
    units: dict[tuple[int, tuple[str, ...]], int] = {}
    for row in rows:
        units.setdefault((row.look, row.names), len(units))
    return units


def _by_unit(group: RowsOfKinds, strange: Array) -> dict[int, float]:
    """How strange each unit looks in the picture in which it looks least so."""
    rows = list(group.rows)
    unit = _units(rows)
    found: dict[int, float] = {}
    for row, value in zip(rows, strange, strict=True):
        number = unit[row.look, row.names]
        found[number] = min(found.get(number, np.inf), float(value))
    return found


def _result(word: str, kinds: Kinds, taught: TaughtWord, strange: Mapping[int, float], bars: Bars) -> WordResult:
    answered = right = 0
    for unit, score, label in zip(taught.units, taught.scores, taught.labels, strict=True):
        p = taught.calibration.probability(float(score))
        if max(p, 1 - p) >= bars.sure and strange[int(unit)] <= bars.strange:
            answered += 1
            right += (p > 0.5) == label
    return WordResult(
        word, kinds, len(taught.labels), int(taught.labels.sum()), answered, right, taught.calibration.error
    )
