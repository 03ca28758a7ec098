"""Conditions and actions of PDDL as data: negation stands at literals only, implications are disjunctions.

Terms are names: variables begin with ``?``, everything else is an object.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TypedName:
    """A parameter or a variable of a quantifier, with the names of the types of which it may be any."""

    name: str
    types: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Literal:
    """A predicate applied to terms, or its negation."""

    predicate: str
    terms: tuple[str, ...]
    positive: bool = True


@dataclass(frozen=True, slots=True)
class Equality:
    """That two terms are the same object.

    With ``positive`` False: that they are not.
    """

    left: str
    right: str
    positive: bool = True


@dataclass(frozen=True, slots=True)
class And:
    """All of ``parts``; true without any."""

    parts: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Or:
    """One of ``parts``; false without any."""

    parts: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Quantified:
    """``body`` for every choice of objects for ``variables`` (``universal``), or for one at least."""

    universal: bool
    variables: tuple[TypedName, ...]
    body: Formula


Formula = Literal | Equality | And | Or | Quantified
TRUE = And(())


def negation(formula: Formula) -> Formula:
    """What holds exactly when ``formula`` does not."""
    match formula:
        case Literal(predicate, terms, positive):
            return Literal(predicate, terms, not positive)
        case Equality(left, right, positive):
            return Equality(left, right, not positive)
        case And(parts):
            return Or(tuple(negation(p) for p in parts))
        case Or(parts):
            return And(tuple(negation(p) for p in parts))
        case Quantified(universal, variables, body):
            return Quantified(not universal, variables, negation(body))


def conjuncts(formula: Formula) -> tuple[Formula, ...]:
    """The parts of nested conjunctions."""
    if isinstance(formula, And):
        return tuple(c for part in formula.parts for c in conjuncts(part))
    return (formula,)


def substituted(formula: Formula, terms: Mapping[str, str]) -> Formula:
    """``formula`` with other terms in place of those that ``terms`` lists; no quantifier may bind one of them."""

    def new(term: str) -> str:
        return terms.get(term, term)

    match formula:
        case Literal(predicate, old, positive):
            return Literal(predicate, tuple(new(t) for t in old), positive)
        case Equality(left, right, positive):
            return Equality(new(left), new(right), positive)
        case And(parts):
            return And(tuple(substituted(p, terms) for p in parts))
        case Or(parts):
            return Or(tuple(substituted(p, terms) for p in parts))
        case Quantified(universal, variables, body):
            return Quantified(universal, variables, substituted(body, terms))


@dataclass(frozen=True, slots=True)
class Effect:
    """That ``literal`` becomes true, for every choice of objects for ``variables`` for which ``condition`` held."""

    variables: tuple[TypedName, ...]
    condition: Formula
    literal: Literal


@dataclass(frozen=True, slots=True)
class FunctionValue:
    """The value of a static function for ``terms``, which are variables and constants.

    It is the same in all states, so that it is known once the variables are bound.
    """

    function: str
    terms: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PddlAction:
    """An action of a domain. It costs the sum of ``costs``; what it deletes and adds at once is added."""

    name: str
    parameters: tuple[TypedName, ...]
    precondition: Formula
    effects: tuple[Effect, ...]
    costs: tuple[int | FunctionValue, ...]


@dataclass(frozen=True, slots=True)
class DerivedPredicate:
    """A rule: ``head`` holds of ``parameters`` wherever ``body`` does, and nowhere else but by other rules."""

    head: str
    parameters: tuple[TypedName, ...]
    body: Formula
