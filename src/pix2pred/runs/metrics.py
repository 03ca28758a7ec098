"""``metrics.json``: counts of what was asked and learned, and what a person should know about them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pix2pred.learning import ClimbEnd, LearningSettings, Selection
from pix2pred.pipeline import Gathered, LearningProblem, Selected
from pix2pred.predicates import Occurrence, goal_warnings
from pix2pred.runs.verdict import Climbed, concerns
from pix2pred.structs import Label, TruthTable
from pix2pred.structs.samplers import Sampler

_SHOWN_GAPS = 5


def asked_metrics(problem: LearningProblem, asked: Gathered) -> dict[str, Any]:
    """Counts of what the model was asked and said."""
    table, gaps = asked.labelling.table, asked.labelling.gaps
    return {
        "labels_from": problem.vlm.name,
        "demonstrations": len(problem.demos),
        "transitions": sum(len(d.actions) for d in problem.demos),
        "proposed": sum(len(p.accepted) for p in asked.proposals),
        "rejected": sum(len(p.rejected) for p in asked.proposals),
        "label_problems": dict(sorted((k, v) for k, v in asked.labelling.counts.items() if v and k != Occurrence.READ)),
        "labels": sum(d.values.size for d in table.demos),
        "labels_without_answer": sum(len(gap.atoms) for gap in gaps),
        "missing_answers": _gap_warnings(asked),
    }


def selected_metrics(
    before: Mapping[str, Any],
    selected: Selected,
    samplers: Mapping[str, Sampler],
    corrections: int,
    settings: LearningSettings,
) -> dict[str, Any]:
    """``before`` brought up to date with what was selected and learned with so many ``corrections``."""
    model, table, selection = selected.model, selected.table, selected.selection
    warnings = [*goal_warnings(table.demos), *before.get("missing_answers", ())]
    lacking = [op.name for op in model.operators if op.skill.dimension and op.name not in samplers]
    if lacking and "samplers" in before:
        warnings.append(
            f"{', '.join(lacking)}: no sampler fits, so parameters are drawn uniformly; samplers need the pictures' "
            "features: run 'pix2pred learn DATA --out RUN' again, which asks nothing that was answered"
        )
    updated = dict(before) | {
        "corrections": corrections,
        "candidates": len(table.candidates()),
        "unknown_labels": table.count(Label.UNKNOWN),
        "warnings": warnings,
        "verdict": [str(c) for c in concerns(model, table.demos, climbed(selection, table, settings))],
        "selected": [p.name for p in selection.selected],
        "operators": len(selection.operators),
        "J": [round(step.j, 4) for step in selection.steps],
        "budget_hits": selection.budget_hits,
    }
    if "samplers" in before:
        updated["samplers"] = {name: sampler.name for name, sampler in samplers.items()}
    return updated


def climbed(selection: Selection, table: TruthTable, settings: LearningSettings) -> Climbed:
    """How selection went, for the verdict."""
    first = selection.steps[0].j if selection.steps else 0.0
    at_once = selection.end is ClimbEnd.GOOD_ENOUGH_AT_ONCE
    return Climbed(len(table.candidates()), at_once, first, settings.j_threshold)


def _gap_warnings(asked: Gathered) -> list[str]:
    """One line per demonstration without a whole proposal, and per state and reason for which labels are missing."""
    lines = [f"{p.demo}: proposal: {p.problem}" for p in asked.proposals if p.problem]
    gaps = asked.labelling.gaps
    lines += [f"{g.about}: {g.purpose}: no value for {len(g.atoms)} atoms ({g.reason})" for g in gaps[:_SHOWN_GAPS]]
    if len(gaps) > _SHOWN_GAPS:
        lines.append(f"and {len(gaps) - _SHOWN_GAPS} more such gaps; all are in labels/gaps.json")
    return lines
