"""Feature predicates from a grammar over object features (method 4; after Silver et al., 2023).

Single-feature inequalities with dyadic constants, their negations and universal quantifications, cheapest constants
first, without two predicates of equal truth. The optional two-object distances of section 4.2 are not generated: they
are off in every published configuration.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pydantic import BaseModel, ConfigDict, Field

from pix2pred.structs import Candidate, Demo, FromFeatures, Predicate, State, Type, groundings
from pix2pred.structs.expressions import AtMost, Expression, ForAll, Not, arguments, evaluate


class GrammarSettings(BaseModel):
    """Limits of the enumeration."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    max_cost: float = Field(13.0, gt=0, description="the first candidate that costs this much ends the enumeration")
    max_candidates: int = Field(100, ge=0, description="feature predicates kept; 0 turns the grammar off")


@dataclass(frozen=True, slots=True)
class _Entry:
    """An expression of the stream with its canonical name and cost.

    ``repeats``: an earlier inequality, or the same wrapping of it, is true of the same objects in the same states.
    """

    expression: Expression
    name: str
    cost: float
    repeats: bool


def feature_predicates(
    demos: Sequence[Demo], types: Sequence[Type], settings: GrammarSettings
) -> tuple[Candidate, ...]:
    """The feature part of the pool, in order of generation; empty when the states have no features."""
    table = {t.name: t for t in types}
    seen: set[frozenset[tuple[int, int, tuple[str, ...]]]] = set()
    kept: list[Candidate] = []
    for entry in _stream(demos, types):
        if entry.cost >= settings.max_cost or len(kept) >= settings.max_candidates:
            break
        if entry.repeats:
            continue
        argument_types = arguments(entry.expression, table)
        truth = frozenset(_true_arguments(entry.expression, argument_types, demos))
        if truth not in seen:
            seen.add(truth)
            source = FromFeatures(str(entry.expression))
            kept.append(Candidate(Predicate(_pddl_safe(entry.name), argument_types, source), entry.cost))
    return tuple(kept)


def _true_arguments(
    expression: Expression, types: Sequence[Type], demos: Sequence[Demo]
) -> Iterator[tuple[int, int, tuple[str, ...]]]:
    for d, demo in enumerate(demos):
        for t, state in enumerate(demo.states):
            for args in groundings(types, state.features, distinct=True):
                if evaluate(expression, state, args):
                    yield d, t, tuple(o.name for o in args)


def _stream(demos: Sequence[Demo], types: Sequence[Type]) -> Iterator[_Entry]:
    """Every inequality followed by its wrappings (4.1, 4.2)."""
    table = {t.name: t for t in types}
    ranges = _ranges([s for demo in demos for s in demo.states], types)
    if not ranges:
        return
    values = {(name, feature): _values(demos, table[name], feature) for name, feature, _, _ in ranges}
    split: set[tuple[str, str, int]] = set()
    for index, (fraction, cost) in enumerate(dyadic_constants()):
        for type_name, feature, low, high in ranges:
            bound = low + fraction * (high - low)
            name = f"((0:{type_name}).{feature}<=[idx {index}]{bound:.3g})"
            below = bisect_right(values[type_name, feature], bound)
            repeats = (type_name, feature, below) in split
            split.add((type_name, feature, below))
            yield from _wrapped(_Entry(AtMost(type_name, feature, bound), name, 1 + cost, repeats), type_name)


def _values(demos: Sequence[Demo], type_: Type, feature: str) -> list[float]:
    """All values an inequality about ``feature`` of ``type_`` looks at, sorted: how many it splits off decides it."""
    return sorted(
        values[o.type.features.index(feature)]
        for demo in demos
        for state in demo.states
        for o, values in state.features.items()
        if o.type.is_a(type_) and feature in o.type.features
    )


def _wrapped(entry: _Entry, type_name: str) -> Iterator[_Entry]:
    """p, for-all p, not for-all p, not p, for-all not p, not for-all not p."""
    for positive in (entry, _Entry(Not(entry.expression), f"NOT-{entry.name}", entry.cost, entry.repeats)):
        every = _Entry(
            ForAll(positive.expression), f"Forall[0:{type_name}].[{positive.name}(0)]", entry.cost + 1, entry.repeats
        )
        yield positive
        yield every
        yield _Entry(Not(every.expression), f"NOT-{every.name}", every.cost, entry.repeats)


def _ranges(states: Sequence[State], types: Sequence[Type]) -> list[tuple[str, str, float, float]]:
    """(type, feature, minimum, maximum) over all states and objects of exactly the type, where they differ."""
    found = []
    for t in sorted(types, key=lambda t: t.name):
        rows = [values for s in states for o, values in sorted(s.features.items()) if o.type == t]
        for i, feature in enumerate(t.features if rows else ()):
            column = [row[i] for row in rows]
            if max(column) - min(column) >= 1e-6:
                found.append((t.name, feature, min(column), max(column)))
    return found


def dyadic_constants() -> Iterator[tuple[float, int]]:
    """(constant, cost): 0.5, then 0.25 and 0.75, ... by breadth-first halving; inside a level the left and right
    subtrees alternate (method 4.1)."""
    level = [0.5]
    cost = 1
    while True:
        yield from ((c, cost) for c in level)
        halves = [c / 2 for c in level]
        level = [c for half in halves for c in (half, half + 0.5)]
        cost += 1


def _pddl_safe(name: str) -> str:
    return name.replace("(", "[").replace(")", "]").replace(" ", "_")
