"""The order in which derived predicates are evaluated: what is used negated is known before."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pix2pred.planning.pddl.formulas import And, DerivedPredicate, Equality, Formula, Literal, Or, Quantified


class CircularNegationError(ValueError):
    """A predicate that is derived from its own negation; the message is its name."""


def strata(rules: Sequence[DerivedPredicate]) -> tuple[frozenset[str], ...]:
    """The derived predicates by levels, the first to be evaluated first. Raises ``CircularNegationError``."""
    level = {rule.head: 0 for rule in rules}
    rising = True
    while rising:
        rising = False
        for rule in rules:
            for literal in _literals(rule.body):
                needed = level.get(literal.predicate, -1) + (not literal.positive)
                if literal.predicate in level and needed > level[rule.head]:
                    if needed >= len(level):
                        raise CircularNegationError(rule.head)
                    level[rule.head], rising = needed, True
    return tuple(frozenset(p for p in level if level[p] == n) for n in sorted(set(level.values())))


def _literals(formula: Formula) -> Iterator[Literal]:
    match formula:
        case Literal():
            yield formula
        case Equality():
            return
        case And(parts) | Or(parts):
            for part in parts:
                yield from _literals(part)
        case Quantified(body=body):
            yield from _literals(body)
