"""Ground tasks with conditional effects, facts that are derived from others, and facts that mirror others."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pix2pred.planning.strips import Relaxed, Strips


@dataclass(frozen=True, slots=True)
class When:
    """What an operator adds and deletes besides, if all of ``facts`` held before it.

    Sets of facts are bits of an int, as everywhere in this room.
    """

    facts: int
    add: int
    delete: int


@dataclass(frozen=True, slots=True)
class Stratum:
    """Rules (facts from which it follows, derived fact), and the facts that they derive.

    The rules of a stratum depend on derived facts of this stratum and earlier ones, and on the mirrors of earlier ones.
    """

    rules: tuple[tuple[int, int], ...]
    derived: int


@dataclass(frozen=True, slots=True)
class ConditionalStrips(Strips):
    """A task with conditional effects (per operator) and derived facts (by strata, the first one first).

    The facts at bits 0 to ``mirrored`` - 1 have mirrors, ``mirrored`` bits higher, which are true when they are false:
    so a negative condition is a condition on a mirror.
    """

    conditional: tuple[tuple[When, ...], ...] = ()
    strata: tuple[Stratum, ...] = ()
    mirrored: int = 0

    def successor(self, state: int, k: int) -> int:
        """The state after operator ``k``: conditions of effects are looked at before it, derived facts follow."""
        add, delete = self.add[k], self.delete[k]
        missing = ~state
        for when in self.conditional[k]:
            if not when.facts & missing:
                add |= when.add
                delete |= when.delete
        if self.conditional[k]:  # of a fact that one effect adds and another deletes, the mirror stays false
            add &= ~((add & ((1 << self.mirrored) - 1)) << self.mirrored)
        after = state & ~delete | add
        return self.closed(after) if self.strata else after

    def closed(self, state: int) -> int:
        """``state`` with the derived facts that follow from its other facts, and no others."""
        low = (1 << self.mirrored) - 1
        for stratum in self.strata:
            state &= ~(stratum.derived | (stratum.derived & low) << self.mirrored)
        for stratum in self.strata:
            waiting = stratum.rules
            grown = True
            while grown:
                grown = False
                still = []
                for rule in waiting:
                    body, head = rule
                    if body & ~state:
                        still.append(rule)
                    elif not head & state:
                        state |= head
                        grown = True
                waiting = tuple(still)
            state |= (stratum.derived & low & ~state) << self.mirrored
        return state

    def relaxed(self) -> list[Relaxed]:
        """Each conditional effect is a way of its own; rules and mirrors of derived facts happen by themselves."""
        found = Strips.relaxed(self)
        for k, (pre, effects) in enumerate(zip(self.pre, self.conditional, strict=True)):
            for when in effects:
                together = pre | when.facts
                if when.add & ~together:
                    found.append((together, when.add & ~together, k))
        by_itself = len(self.pre)
        low = (1 << self.mirrored) - 1
        for stratum in self.strata:
            for body, head in stratum.rules:
                found.append((body, head & ~body, by_itself))
                by_itself += 1
            if mirrors := (stratum.derived & low) << self.mirrored:
                found.append((0, mirrors, by_itself))
                by_itself += 1
        return found

    def touched(self) -> int:
        """The facts that some operator changes, under whatever condition, or that are derived."""
        touched = Strips.touched(self)
        for when in (when for effects in self.conditional for when in effects):
            touched |= when.add | when.delete
        for stratum in self.strata:
            touched |= stratum.derived | (stratum.derived & ((1 << self.mirrored) - 1)) << self.mirrored
        return touched

    def without_static_facts(self) -> Strips:
        """The task itself: who makes such tasks leaves static facts out."""
        return self

    def with_initial(self, initial: int) -> ConditionalStrips:
        """The same task from another state."""
        return replace(self, initial=initial)
