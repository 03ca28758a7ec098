"""Deciding conditions for given objects: what never changes is evaluated, the rest becomes alternatives of literals."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from pix2pred.planning.instances import Fact
from pix2pred.planning.pddl.compiling.schemas import Numbers
from pix2pred.planning.pddl.formulas import And, Equality, Formula, Literal, Or, Quantified, TypedName, negation

GroundLiteral = tuple[Fact, bool]
"""A fact, and whether it is to be true or to be false."""

Conjunction = frozenset[GroundLiteral]
NOTHING_NEEDED: Conjunction = frozenset()
MAX_OPERATORS = 16
"""Operators into which an instance is split; for more alternatives a derived fact stands for the disjunction."""

_STANDING_FOR = -1
"""The predicate number of facts that stand for disjunctions."""


@dataclass(frozen=True, slots=True)
class GroundRule:
    """A rule without variables: ``head`` is true in every state in which all literals of ``body`` hold.

    Rules with one head are alternatives.
    """

    body: Conjunction
    head: Fact


@dataclass(frozen=True, slots=True)
class PlacedLiteral:
    """A literal whose terms are places in an instance of a schema."""

    predicate: int
    places: tuple[int, ...]
    positive: bool

    def fact(self, binding: Sequence[int]) -> Fact:
        """The fact that it is about in the instance with these objects."""
        return (self.predicate, *[binding[i] for i in self.places])


@dataclass(frozen=True, slots=True)
class DecidedChanges:
    """Names of the predicates that actions change, of those that actions make false, and of the derived ones."""

    changed: Collection[str]
    deleted: Collection[str]
    derived: Collection[str]


class Decider:
    """Conditions in a task whose ``reached`` facts are all that can become true.

    ``rules`` grows by what defines the facts that stand for disjunctions.
    """

    def __init__(
        self, numbers: Numbers, reached: Collection[Fact], initial: Collection[Fact], changes: DecidedChanges
    ) -> None:
        self._numbers = numbers
        self._reached = reached
        self._initial = initial
        self._changed = {numbers.predicate(p) for p in (*changes.changed, *changes.derived)}
        self._deleted = {numbers.predicate(p) for p in (*changes.deleted, *changes.derived)}
        self.rules: list[GroundRule] = []

    def fact(self, literal: Literal, env: Mapping[str, int]) -> Fact:
        """The fact that ``literal`` is about when its variables are the objects of ``env``."""
        known = self._numbers.object
        return (self._numbers.predicate(literal.predicate), *(env[t] if t in env else known[t] for t in literal.terms))

    def never_changes(self, fact: Fact) -> bool:
        """Whether ``fact`` is as it was in the beginning, whatever is done."""
        if fact[0] not in self._changed or fact not in self._reached:
            return True
        return fact[0] not in self._deleted and fact in self._initial

    def placed(self, formula: Formula, names: Sequence[str]) -> PlacedLiteral | None:
        """A literal whose terms are all among the ``names`` of a schema; ``None`` for any other formula."""
        if not isinstance(formula, Literal) or not set(formula.terms) <= set(names):
            return None
        places = tuple(names.index(t) for t in formula.terms)
        return PlacedLiteral(self._numbers.predicate(formula.predicate), places, formula.positive)

    def left_of(self, literals: Iterable[PlacedLiteral], binding: Sequence[int]) -> Conjunction | None:
        """What of ``literals`` has to hold for the objects of ``binding``; ``None`` when they never all do."""
        needed: list[GroundLiteral] = []
        for literal in literals:
            fact = literal.fact(binding)
            if not self.never_changes(fact):
                needed.append((fact, literal.positive))
            elif (fact in self._initial) != literal.positive:
                return None
        return frozenset(needed)

    def alternatives(
        self, formulas: Iterable[Formula], env: Mapping[str, int], besides: Conjunction = NOTHING_NEEDED
    ) -> list[Conjunction]:
        """Conjunctions of which one holds exactly when all ``formulas`` hold and what is to hold ``besides``.

        None when that is impossible.
        """
        certain = set(besides)
        choices: list[list[Conjunction]] = []
        for formula in formulas:
            found = self._decided(formula, env)
            if not found:
                return []
            if len(found) == 1:
                certain |= found[0]
            else:
                choices.append(found)
        return self._product(frozenset(certain), choices)

    def _product(self, certain: Conjunction, choices: Sequence[list[Conjunction]]) -> list[Conjunction]:
        """All ways to choose one of each of ``choices`` with ``certain``, without contradictions and repetitions."""
        count = 1
        small = []
        for choice in choices:
            if count * len(choice) > MAX_OPERATORS:
                certain |= self.standing_for(choice)
            else:
                count *= len(choice)
                small.append(choice)
        found: dict[Conjunction, None] = {}
        for chosen in product(*small):
            together = certain.union(*chosen)
            if not any((fact, not value) in together for fact, value in together):
                found[together] = None
        return list(found)

    def standing_for(self, choice: Iterable[Conjunction]) -> Conjunction:
        """A derived fact that holds exactly when one of ``choice`` does."""
        head = (_STANDING_FOR, len(self.rules))
        self.rules += [GroundRule(body, head) for body in choice]
        return frozenset(((head, True),))

    def _decided(self, formula: Formula, env: Mapping[str, int]) -> list[Conjunction]:
        match formula:
            case Literal(positive=positive):
                fact = self.fact(formula, env)
                if self.never_changes(fact):
                    return [NOTHING_NEEDED] if (fact in self._initial) == positive else []
                return [frozenset(((fact, positive),))]
            case Equality(left, right, positive):
                return [NOTHING_NEEDED] if (self._object(left, env) == self._object(right, env)) == positive else []
            case And(parts):
                return self.alternatives(parts, env)
            case Or(parts):
                return self._any((p, env) for p in parts)
            case Quantified(universal, variables, body):
                inner = ({**env, **chosen} for chosen in self._choices(variables))
                if not universal:
                    return self._any((body, chosen) for chosen in inner)
                failing = self._any((negation(body), chosen) for chosen in inner)
                return self._none_of(failing)
        raise AssertionError(f"{formula} is no formula")

    def _any(self, cases: Iterable[tuple[Formula, Mapping[str, int]]]) -> list[Conjunction]:
        found: dict[Conjunction, None] = {}
        for formula, env in cases:
            for conjunction in self._decided(formula, env):
                if not conjunction:
                    return [NOTHING_NEEDED]
                found[conjunction] = None
        return list(found)

    def _none_of(self, conjunctions: list[Conjunction]) -> list[Conjunction]:
        """Alternatives that hold exactly when none of ``conjunctions`` does."""
        if NOTHING_NEEDED in conjunctions:
            return []
        choices = [[frozenset(((fact, not value),)) for fact, value in sorted(c)] for c in conjunctions]
        certain = frozenset().union(*(c[0] for c in choices if len(c) == 1))
        return self._product(certain, [c for c in choices if len(c) > 1])

    def _choices(self, variables: Sequence[TypedName]) -> Iterable[dict[str, int]]:
        members = [sorted(self._numbers.members(v)) for v in variables]
        for chosen in product(*members):
            yield dict(zip((v.name for v in variables), chosen, strict=True))

    def _object(self, term: str, env: Mapping[str, int]) -> int:
        return env[term] if term in env else self._numbers.object[term]
