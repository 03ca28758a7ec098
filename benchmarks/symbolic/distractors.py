"""Candidate predicates: the hidden ones among synonyms, negations, relatives, histories and nonsense.

Every candidate has a true value in every problem, so that a model which selects it can be tested.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from random import Random

from pix2pred.planning.pddl.read import PddlDomain
from pix2pred.structs import AbstractState, FromDomain, GroundOperator, Object, Predicate, Type, groundings

Args = tuple[Object, ...]
MOST_ARGUMENTS = 2
"""Predicates of more arguments have too many atoms to be asked about one by one."""


@dataclass(frozen=True, slots=True)
class Moment:
    """A state and what led to it; at the start of a problem ``past`` and ``before`` are empty."""

    problem: str
    objects: tuple[Object, ...]
    state: AbstractState
    before: AbstractState
    past: tuple[GroundOperator, ...]

    def extension(self, predicate: Predicate) -> set[Args]:
        """The arguments of which a true predicate holds now."""
        return {a.objects for a in self.state if a.predicate == predicate}

    def all(self, types: Sequence[Type]) -> list[Args]:
        """Every tuple of distinct objects of the types."""
        return list(groundings(types, self.objects, distinct=True))


Truth = Callable[[Moment], set[Args]]


@dataclass(frozen=True, slots=True)
class Column:
    """A candidate, how its true value follows from what happens, and whether it is (a synonym of) a hidden one."""

    predicate: Predicate
    truth: Truth
    meaning: str


def chance(*words: object) -> float:
    """A number in [0, 1) that is a function of ``words`` alone."""
    digest = blake2b("/".join(map(str, words)).encode(), digest_size=8).digest()
    return int.from_bytes(digest, "big") / 2**64


def candidates(domain: PddlDomain, hidden: Sequence[Predicate], seed: str, count: int) -> tuple[Column, ...]:
    """``count`` candidates in random order: the hidden predicates first drawn, then distractors of all kinds."""
    rng = Random(f"{seed}/candidates")
    makers = _makers(domain, hidden, seed)
    kinds = sorted({kind for kind, _, _, _ in makers})
    chosen: list[tuple[str, tuple[Type, ...], Truth]] = [(p.name, p.types, _same(p)) for p in hidden]
    by_kind = {kind: rng.sample(found := [m for m in makers if m[0] == kind], len(found)) for kind in kinds}
    while len(chosen) < count:
        kind = rng.choice([k for k in kinds if by_kind[k]])
        _, name, types, truth = by_kind[kind].pop()
        chosen.append((f"{kind}-{name}", types, truth))
    numbers = rng.sample(range(100, 1000), len(chosen))
    columns = [
        Column(Predicate(f"q{n}_{name}", types, FromDomain()), truth, name)
        for n, (name, types, truth) in zip(numbers, chosen, strict=True)
    ]
    return tuple(sorted(columns, key=lambda c: c.predicate))


def _makers(
    domain: PddlDomain, hidden: Sequence[Predicate], seed: str
) -> list[tuple[str, str, tuple[Type, ...], Truth]]:
    """(kind, name, types, truth) of everything that may stand beside the hidden predicates."""
    changing = {a.predicate for op in domain.operators for a in (*op.add, *op.delete)}
    small = [p for p in domain.predicates if p.arity <= MOST_ARGUMENTS]
    fluents = [p for p in small if p in changing]
    used = sorted({v.type for op in domain.operators for v in op.parameters}, key=lambda t: t.name)
    made: list[tuple[str, str, tuple[Type, ...], Truth]] = []
    for p in hidden:
        made.append(("same", p.name, p.types, _same(p)))
        made.append(("late", p.name, p.types, _late(p)))
        made += [("blurred", f"{p.name}-{i}", p.types, _blurred(p, f"{seed}/{i}")) for i in range(2)]
    made += [("not", p.name, p.types, _negated(p)) for p in fluents]
    made += [("swapped", p.name, p.types[::-1], _swapped(p)) for p in small if p.arity == MOST_ARGUMENTS]
    made += [("some", f"{p.name}-{i}", (p.types[i],), _some(p, i)) for p in fluents if p.arity == 2 for i in range(2)]
    unary = [(p, i) for p in fluents for i in range(p.arity)]
    for a, (p, i) in enumerate(unary):
        for q, j in unary[a + 1 :]:
            if p.types[i] == q.types[j] and p != q:
                made.append(("both", f"{p.name}-{q.name}-{i}{j}", (p.types[i],), _both(p, i, q, j)))
    for op in domain.operators:
        made += [
            ("after", f"{op.name}-{i}", (v.type,), _after(op.name, i))
            for i, v in enumerate(op.parameters)
        ]  # fmt: skip
    for t in used:
        for i in range(8):
            made.append(("kind", f"{t.name}-{i}", (t,), _by_name(t, f"{seed}/{i}", everywhere=i < 4)))
        for percent in (5, 10, 20, 30, 50, 80, 90, 95):
            made.append(("flicker", f"{t.name}-{percent}", (t,), _flicker((t,), seed, percent / 100)))
        made.append(("touched", t.name, (t,), _touched(t, last_only=False)))
        made.append(("handled", t.name, (t,), _touched(t, last_only=True)))
        made.append(("any", t.name, (t,), _flicker((t,), seed, 1.0)))
        made.append(("odd", t.name, (t,), _flicker((t,), f"{seed}/odd", 0.02)))
        made.append(("most", t.name, (t,), _flicker((t,), f"{seed}/most", 0.98)))
    made.append(("flicker", "scene", (), _flicker((), seed, 0.5)))
    for p in small:
        if p.arity == MOST_ARGUMENTS:
            made.append(("flicker", f"like-{p.name}", p.types, _flicker(p.types, seed, 0.2)))
    return made


def _same(p: Predicate) -> Truth:
    return lambda now: now.extension(p)


def _late(p: Predicate) -> Truth:
    return lambda now: {a.objects for a in (now.before if now.past else now.state) if a.predicate == p}


def _blurred(p: Predicate, seed: str) -> Truth:
    def truth(now: Moment) -> set[Args]:
        held = now.extension(p)
        t = len(now.past)
        return {
            args
            for args in now.all(p.types)
            if (args in held) != (chance(seed, p, now.problem, t, *args) < 0.2)
        }  # fmt: skip

    return truth


def _negated(p: Predicate) -> Truth:
    return lambda now: set(now.all(p.types)) - now.extension(p)


def _swapped(p: Predicate) -> Truth:
    return lambda now: {args[::-1] for args in now.extension(p)}


def _some(p: Predicate, i: int) -> Truth:
    return lambda now: {(args[i],) for args in now.extension(p)}


def _both(p: Predicate, i: int, q: Predicate, j: int) -> Truth:
    def truth(now: Moment) -> set[Args]:
        first: set[Args] = {(args[i],) for args in now.extension(p)}
        return first & {(args[j],) for args in now.extension(q)}

    return truth


def _after(action: str, i: int) -> Truth:
    return lambda now: {(step.objects[i],) for step in now.past if step.operator.name == action}


def _touched(t: Type, *, last_only: bool) -> Truth:
    def truth(now: Moment) -> set[Args]:
        steps = now.past[-1:] if last_only else now.past
        return {(o,) for step in steps for o in step.objects if o.type.is_a(t)}

    return truth


def _by_name(t: Type, seed: str, *, everywhere: bool) -> Truth:
    """A property that never changes: of all objects of a name, or drawn anew in every problem."""

    def truth(now: Moment) -> set[Args]:
        where = "" if everywhere else now.problem
        return {args for args in now.all((t,)) if chance(seed, where, args[0]) < 0.5}

    return truth


def _flicker(types: Sequence[Type], seed: str, rate: float) -> Truth:
    def truth(now: Moment) -> set[Args]:
        t = len(now.past)
        return {args for args in now.all(types) if chance(seed, rate, now.problem, t, *args) < rate}

    return truth
