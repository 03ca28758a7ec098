"""Runs side by side: what each is, and how two of them differ."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pix2pred.learning import load_traces
from pix2pred.runs.folder import Difference, RunFolder, RunFolderError, differences
from pix2pred.runs.layout import CONFIG, METRICS, MODEL, SOLVED, SUMMARY, TRACES
from pix2pred.runs.verdict import sentences
from pix2pred.structs import LabelledDemo
from pix2pred.structs.formats.world_model import load_model
from pix2pred.system.files import read_regular

DEEPEST = 4
"""Levels of folders below the one that is searched."""


@dataclass(frozen=True, slots=True)
class RunRow:
    """A run in a line: ``metrics`` is None while it is not finished; ``solved`` has (solved, tasks) by name."""

    folder: Path
    model: str
    metrics: dict[str, Any] | None
    solved: dict[str, tuple[int, int]]


def runs_below(folder: Path) -> list[RunRow]:
    """Every run in ``folder``, sorted by path. Runs of benchmarks are no runs of learning and are left out."""
    return [row for path in sorted(_configs(folder, DEEPEST)) if (row := _row(path.parent)) is not None]


def _configs(folder: Path, levels: int) -> Iterator[Path]:
    if (folder / CONFIG).is_file():
        yield folder / CONFIG
    elif levels and folder.is_dir():
        for below in folder.iterdir():
            if below.is_dir() and not below.is_symlink() and not below.name.startswith("."):
                yield from _configs(below, levels - 1)


def _row(folder: Path) -> RunRow | None:
    try:
        config = RunFolder(folder).config()
        if "settings" not in config or "model" not in config:
            return None
        metrics = _json(folder / METRICS) if (folder / METRICS).is_file() else None
        solved = {p.parent.name: _json(p) for p in sorted(folder.glob(f"{SOLVED}/*/{SUMMARY}"))}
        counts = {name: (int(s["solved"]), int(s["tasks"])) for name, s in solved.items()}
    except (RunFolderError, ValueError, KeyError, TypeError):
        return RunRow(folder, "(damaged)", None, {})
    return RunRow(folder, str(config["model"]), metrics, counts)


@dataclass(frozen=True, slots=True)
class LabelCount:
    """How the labels of one predicate differ between two runs.

    ``labels`` counts those that both have, ``differ`` those of them that are not equal; ``example`` is one in words.
    """

    predicate: str
    labels: int
    differ: int
    example: str


@dataclass(frozen=True, slots=True)
class Comparison:
    """How two runs differ; tuples of two hold what only the first and only the second has."""

    settings: tuple[Difference, ...]
    labels: tuple[LabelCount, ...]
    predicates: tuple[tuple[str, ...], tuple[str, ...]]
    operators: tuple[tuple[str, ...], tuple[str, ...]]

    @property
    def equal(self) -> bool:
        """Whether nothing differs."""
        return not (self.settings or self.labels or any(self.predicates) or any(self.operators))


def compare(one: Path, other: Path) -> Comparison:
    """Compare two finished runs. Raises ``RunFolderError`` for a folder without one."""
    for folder in (one, other):
        RunFolder(folder).config()
        if not (folder / MODEL).is_file():
            raise RunFolderError(f"{folder / MODEL}: is missing; finish the run first with 'pix2pred learn'")
    models = [load_model(folder / MODEL) for folder in (one, other)]
    chosen = [{p.name for p in m.selected} for m in models]
    said = [set(sentences(m.operators)) for m in models]
    return Comparison(
        tuple(differences(RunFolder(one).config(), RunFolder(other).config())),
        _labels(load_traces(one / TRACES).table.demos, load_traces(other / TRACES).table.demos),
        (tuple(sorted(chosen[0] - chosen[1])), tuple(sorted(chosen[1] - chosen[0]))),
        (tuple(sorted(said[0] - said[1])), tuple(sorted(said[1] - said[0]))),
    )


def _labels(one: tuple[LabelledDemo, ...], other: tuple[LabelledDemo, ...]) -> tuple[LabelCount, ...]:
    """Labels that differ, by predicate, of demonstrations and atoms that both have; the most different first."""
    total: Counter[str] = Counter()
    wrong: Counter[str] = Counter()
    examples: dict[str, str] = {}
    by_name = {demo.name: demo for demo in other}
    for demo in one:
        twin = by_name.get(demo.name)
        if twin is None or len(twin.values) != len(demo.values):
            continue
        columns = {str(atom): i for i, atom in enumerate(twin.atoms)}
        for i, atom in enumerate(demo.atoms):
            if (j := columns.get(str(atom))) is None:
                continue
            name = atom.predicate.name
            for state, (a, b) in enumerate(zip(demo.values[:, i], twin.values[:, j], strict=True)):
                total[name] += 1
                wrong[name] += int(a != b)
                if a != b:
                    examples.setdefault(name, f"{atom} in {demo.name}, state {state}")
    found = [LabelCount(name, total[name], count, examples[name]) for name, count in wrong.items() if count]
    return tuple(sorted(found, key=lambda c: (-c.differ, c.predicate)))


def _json(path: Path) -> Any:
    return json.loads(read_regular(path))
