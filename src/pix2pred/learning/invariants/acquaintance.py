"""What a world model knows beside its operators: error rates of labels, first states, and invariants."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pix2pred.learning.invariants.believed import Believed
from pix2pred.learning.invariants.groups import mutex_groups
from pix2pred.learning.invariants.implications import implications
from pix2pred.learning.invariants.settings import DEFAULTS, AcquaintanceSettings
from pix2pred.structs import FromVLM, Operator, Predicate, TruthTable
from pix2pred.structs.knowledge import Invariant, Reliability

PLACES = 6
"""Decimal places of estimates, the same in memory and in files."""


@dataclass(frozen=True, slots=True)
class Acquaintance:
    """How far each predicate's labels can be trusted, and what always holds."""

    reliability: tuple[Reliability, ...]
    invariants: tuple[Invariant, ...]


def acquaint(
    table: TruthTable,
    predicates: Sequence[Predicate],
    operators: Sequence[Operator],
    settings: AcquaintanceSettings = DEFAULTS,
) -> Acquaintance:
    """Learns from ``table`` what the ``predicates`` of a world model with ``operators`` are like."""
    if not table.demos:
        return Acquaintance((), ())
    believed = Believed(table, predicates)
    visual = [p for p in sorted(predicates) if isinstance(p.source, FromVLM)]
    groups = mutex_groups(believed.demos, predicates, operators, settings)
    implied = implications(believed.demos, predicates, operators, groups, settings)
    return Acquaintance(_reliability(believed, visual, settings), (*groups, *implied))


def _reliability(
    believed: Believed, visual: Sequence[Predicate], settings: AcquaintanceSettings
) -> tuple[Reliability, ...]:
    """Estimates per predicate, each drawn towards what all of them show together."""
    counts = {p: believed.counts(p) for p in visual}
    labels, wrong = sum(c.known for c in counts.values()), sum(c.wrong for c in counts.values())
    weight = settings.prior_labels
    usual = (wrong + weight * settings.prior_error) / (labels + weight)
    found = []
    for predicate, count in counts.items():
        error = max(settings.least_error, (count.wrong + weight * usual) / (count.known + weight))
        unknown = count.unknown / max(1, count.known + count.unknown)
        initially = (count.first_true + settings.prior_states / 2) / (count.first + settings.prior_states)
        found.append(Reliability(predicate, round(error, PLACES), round(unknown, PLACES), round(initially, PLACES)))
    return tuple(found)
