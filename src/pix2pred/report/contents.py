"""Everything a report shows, read from a run folder and from nowhere else."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from pix2pred.learning import ClimbEnd, Support, load_traces, operator_support
from pix2pred.predicates import Corrections, ground_atoms
from pix2pred.predicates.correction_rows import Row, read_rows
from pix2pred.predicates.corrections import with_atoms
from pix2pred.predicates.labelling.evidence import Evidence, load_evidence
from pix2pred.runs.addresses import stores_of_pictures
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.runs.layout import (
    ADVICE,
    AS_SAID,
    CORRECTIONS,
    EVIDENCE,
    HISTORY,
    METRICS,
    MODEL,
    PROPOSALS,
    SELECTION,
    SOLVED,
    SUMMARY,
    TIMINGS,
    TRACES,
)
from pix2pred.runs.verdict import Climbed, Concern, concerns
from pix2pred.structs import TruthTable, WorldModel
from pix2pred.structs.formats.world_model import load_model
from pix2pred.system.files import read_regular


@dataclass(frozen=True)
class Contents:
    """A finished run. ``said`` are the model's labels, ``table`` the corrected ones that the world model comes from."""

    folder: Path
    config: Mapping[str, Any]
    model: WorldModel
    said: TruthTable
    table: TruthTable
    evidence: Evidence
    advice: Mapping[str, Any]
    selection: Mapping[str, Any]
    metrics: Mapping[str, Any]
    timings: Mapping[str, Any]
    proposals: list[dict[str, Any]]
    history: list[dict[str, Any]]
    solved: Mapping[str, Mapping[str, Any]]
    rows: tuple[Row, ...]

    @cached_property
    def corrections(self) -> Corrections:
        """What the corrections amount to, those not yet learned with included."""
        return Corrections.of(self.rows)

    @cached_property
    def learned_corrections(self) -> Corrections:
        """The corrections that the world model was learned with."""
        return Corrections.of(self.rows[: int(self.metrics.get("corrections", 0))])

    @cached_property
    def shown(self) -> TruthTable:
        """All ground atoms under the names the model used, with labels as a person left them."""
        predicates = (*self.said.initial, *(c.predicate for c in self.said.pool))
        demos = tuple(with_atoms(d, ground_atoms(predicates, d.objects)) for d in self.said.demos)
        only_labels = Corrections(labels=self.corrections.labels)
        return only_labels.apply(TruthTable(self.said.initial, self.said.pool, demos)).table

    @cached_property
    def readings(self) -> list[Support]:
        """Which transitions support or contradict which operator."""
        return operator_support(self.model.operators, [d.restricted(self.model.predicates) for d in self.table.demos])

    def original(self, predicate: str) -> str:
        """What the model called a predicate that may have been renamed."""
        names = {new: old for old, new in self.learned_corrections.names.items()}
        return names.get(predicate, predicate)

    @cached_property
    def verdict(self) -> tuple[Concern, ...]:
        """What is wrong with the world model; empty when nothing stands out."""
        steps, learning = self.selection["steps"], self.config["settings"]["learning"]
        climbed = Climbed(
            int(self.metrics["candidates"]),
            self._ended_at_once,
            float(steps[0]["J"]) if steps else 0.0,
            learning.get("j_threshold"),
        )
        return concerns(self.model, self.table.demos, climbed)

    @property
    def _ended_at_once(self) -> bool:
        """Whether no candidate was tried; runs of before version 0.2 tell by how many sets they tried."""
        if "end" in self.selection:
            return ClimbEnd(self.selection["end"]) is ClimbEnd.GOOD_ENOUGH_AT_ONCE
        return bool(self.selection["steps"] and self.selection["evaluations"] <= 1 and self.metrics["candidates"])

    @property
    def blobs(self) -> tuple[Path, ...]:
        """Folders that may hold the pictures, by digest: of the run's answers, and of those it replays."""
        return tuple(store / "blobs" for store in stores_of_pictures(self.folder, self.config))


def load_contents(run: RunFolder) -> Contents:
    """Read a run. Raises ``RunFolderError`` for a folder without a finished run."""
    path = run.path
    config = run.config()
    missing = [n for n in (MODEL, AS_SAID, EVIDENCE, ADVICE, SELECTION, METRICS) if not (path / n).exists()]
    if missing:
        raise RunFolderError(f"{path / missing[0]}: is missing; finish the run with 'pix2pred learn DATA --out {path}'")
    return Contents(
        path,
        config,
        load_model(path / MODEL),
        load_traces(path / AS_SAID).table,
        load_traces(path / TRACES).table,
        load_evidence(path / EVIDENCE),
        _json(path / ADVICE),
        _json(path / SELECTION),
        _json(path / METRICS),
        _json(path / TIMINGS) if (path / TIMINGS).exists() else {},
        _json(path / PROPOSALS) if (path / PROPOSALS).exists() else [],
        [_json(p) for p in sorted((path / HISTORY).glob("*.json"))],
        {p.parent.name: _json(p) for p in sorted((path / SOLVED).glob(f"*/{SUMMARY}"))},
        read_rows(path / CORRECTIONS),
    )


def _json(path: Path) -> Any:
    try:
        return json.loads(read_regular(path))
    except (OSError, ValueError, RecursionError) as error:
        raise RunFolderError(f"{path}: is damaged ({error}); run the command that wrote it again") from error
