"""Ground operators and rules laid out as bits: which fact is which bit, and which facts have a mirror."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Hashable, Iterable, Sequence
from dataclasses import dataclass

from pix2pred.planning.conditional import ConditionalStrips, Stratum, When
from pix2pred.planning.grounding import bits_of, check_size
from pix2pred.planning.instances import Fact
from pix2pred.planning.pddl.compiling.decided import Conjunction, GroundRule
from pix2pred.planning.strips import Strips


@dataclass(frozen=True, slots=True)
class GroundEffect:
    """That ``fact`` becomes true or false (``becomes``) if ``condition`` held before."""

    condition: Conjunction
    fact: Fact
    becomes: bool


@dataclass(frozen=True, slots=True)
class GroundOperation:
    """A ground operator before its facts have bits.

    It may run where ``condition`` holds, has all ``effects`` whose own conditions held then, and costs ``cost``.
    """

    condition: Conjunction
    effects: tuple[GroundEffect, ...]
    cost: int


def operation(condition: Conjunction, effects: Iterable[GroundEffect], cost: int) -> GroundOperation | None:
    """The operator with what is clear from its own condition left out; ``None`` when nothing changes.

    An effect whose condition contradicts the operator's never happens; what is deleted and added at once is added.
    """
    effects = tuple(dict.fromkeys(effects))
    if not any(e.condition for e in effects):
        added = {e.fact for e in effects if e.becomes}
        lasting = [e for e in effects if e.becomes or e.fact not in added]
        changing = tuple([e for e in lasting if (e.fact, e.becomes) not in condition])
        return GroundOperation(condition, changing, cost) if changing else None
    possible = []
    for effect in effects:
        if not any((fact, not value) in condition for fact, value in effect.condition):
            possible.append(GroundEffect(effect.condition - condition, effect.fact, effect.becomes))
    added = {e.fact for e in possible if e.becomes and not e.condition}
    left = tuple(dict.fromkeys(e for e in possible if e.becomes or e.fact not in added))
    alone = {e.fact: sum(1 for o in left if o.fact == e.fact) for e in left}
    changing = tuple(e for e in left if alone[e.fact] > 1 or (e.fact, e.becomes) not in condition)
    return GroundOperation(condition, changing, cost) if changing else None


def task_of(
    operations: Sequence[GroundOperation],
    rules: Sequence[GroundRule],
    initial: Collection[Fact],
    goal: Conjunction,
    *,
    use_costs: bool,
    kinds: tuple[Hashable, ...] = (),
) -> Strips:
    """The task on bits. Facts that no condition mentions get none. ``kinds`` of objects as in ``Strips``.

    Raises ``GroundingBudgetError`` when the bits would fill the memory.
    """
    bits = _Bits(operations, rules, goal)
    check_size(bits.count, len(operations))
    made = [bits.operator(o) for o in operations]
    strata = bits.strata(rules)
    start = bits_of([bits.place[f] for f in initial if f in bits.place])
    start |= bits_of(bits.place[f] + bits.mirrored for f in bits.negative if f not in initial)
    costs = tuple(o.cost for o in operations) if use_costs else ()
    pre, add, delete = tuple(m[0] for m in made), tuple(m[1] for m in made), tuple(m[2] for m in made)
    if not strata and not any(m[3] for m in made):
        return Strips(bits.count, pre, add, delete, start, bits.mask(goal), costs, bits.atoms(), kinds)
    conditional = tuple(m[3] for m in made)
    task = ConditionalStrips(
        bits.count, pre, add, delete, start, bits.mask(goal), costs,
        conditional=conditional, strata=strata, mirrored=bits.mirrored,
    )  # fmt: skip
    return task.with_initial(task.closed(start))


class _Bits:
    """Places of facts: first those that are wanted false somewhere, then their mirrors, then all others."""

    def __init__(self, operations: Iterable[GroundOperation], rules: Iterable[GroundRule], goal: Conjunction) -> None:
        conditions = [goal, *(r.body for r in rules)]
        for operation in operations:
            conditions.append(operation.condition)
            conditions += [e.condition for e in operation.effects]
        mentioned: set[Fact] = set()
        negative: set[Fact] = set()
        for condition in conditions:
            for fact, value in condition:
                mentioned.add(fact)
                if not value:
                    negative.add(fact)
        self.negative = sorted(negative)
        self.mirrored = len(self.negative)
        others = sorted(mentioned - negative)
        self.place = {f: i for i, f in enumerate(self.negative)}
        self.place |= {f: i for i, f in enumerate(others, start=2 * self.mirrored)}
        self.count = 2 * self.mirrored + len(others)
        self._negative = negative

    def atoms(self) -> tuple[tuple[int, ...], ...]:
        """What every bit is about; the predicates of mirrors are numbered downwards from -1."""
        mirrors = [(-1 - predicate, *objects) for predicate, *objects in self.negative]
        return (*self.negative, *mirrors, *list(self.place)[self.mirrored :])

    def mask(self, literals: Conjunction) -> int:
        """The bits that are set exactly when ``literals`` hold."""
        mask = 0
        for fact, value in literals:
            mask |= 1 << (self.place[fact] if value else self.place[fact] + self.mirrored)
        return mask

    def operator(self, operation: GroundOperation) -> tuple[int, int, int, tuple[When, ...]]:
        """Preconditions, add and delete effects, and conditional effects."""
        plain = [0, 0]
        special: dict[Conjunction, list[int]] = defaultdict(lambda: [0, 0])
        for effect in operation.effects:
            if effect.fact not in self.place:
                continue
            masks = special[effect.condition] if effect.condition else plain
            place = self.place[effect.fact]
            masks[not effect.becomes] |= 1 << place
            if effect.fact in self._negative:
                masks[effect.becomes] |= 1 << (place + self.mirrored)
        whens = tuple(When(self.mask(c), add, delete) for c, (add, delete) in special.items())
        return self.mask(operation.condition), plain[0], plain[1], whens

    def strata(self, rules: Sequence[GroundRule]) -> tuple[Stratum, ...]:
        """The rules by levels: a fact is above the derived facts that must be false for it."""
        level = {rule.head: 0 for rule in rules}
        rising = True
        while rising:
            rising = False
            for rule in rules:
                needed = max((level[f] + (not value) for f, value in rule.body if f in level), default=0)
                if needed > level[rule.head]:
                    assert needed <= len(level), "derived predicates negate themselves in a circle"
                    level[rule.head], rising = needed, True
        found = []
        for wanted in sorted(set(level.values())):
            chosen = [r for r in rules if level[r.head] == wanted and r.head in self.place]
            heads = bits_of(self.place[r.head] for r in chosen)
            if chosen:
                found.append(Stratum(tuple((self.mask(r.body), 1 << self.place[r.head]) for r in chosen), heads))
        return tuple(found)
