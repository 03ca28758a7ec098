"""Operators from labels that are sometimes wrong: repaired labels, effects by likelihood, preconditions by test.

Transitions are first told apart by the predicates that are taken at their word, the given ones; this partition does not
depend on the labels of a model. Within it, ``repair`` estimates for every other predicate how often its labels are
wrong and what each class of transitions does to it. A class is split only where a predicate's effect is significantly
mixed; an atom is a precondition unless the members in which it does not hold are more than its wrong labels explain.
No threshold is left to tune: ``h_pre_frac`` and ``h_data_frac`` are not used.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from pix2pred.learning.labels.hidden_markov import ADD, DELETE, MIXED, repair
from pix2pred.learning.operators.cluster_and_intersect import Schema
from pix2pred.learning.operators.clustering import Lifted, Member, Memo, Partition, TransitionClass, partition
from pix2pred.learning.transitions import Data
from pix2pred.structs import FromVLM

CERTAIN = 1e-9
"""Probability that a given atom's value is wrong."""

CONFIDENT = 1e-4
"""Probability that a repaired label without doubt is wrong."""


UNRELIABLE = 0.2
"""Candidates whose labels are wrong more often are not considered: at test time they would be wrong as often."""


DOUBT = 50.0
"""Price of wrong labels, in arguments: two in a hundred weigh as much as one argument more."""


Effects = Sequence[tuple[tuple[int, ...], int]]
"""What a predicate's atoms over some variables become: ADD, DELETE or MIXED."""


class Robust:
    """Operators that survive wrong labels."""

    def __init__(self, data: Data) -> None:
        given = range(data.initial)
        self._exact = [p for p in given if not isinstance(data.predicates[p].source, FromVLM)]
        noisy = [p for p in range(len(data.predicates)) if p not in set(self._exact)]
        self._base = partition(data, self._exact)
        self._repaired = repair(data, self._base, noisy)
        self._base_of = {m.transition: c for c, cls in enumerate(self._base) for m in cls.members}
        self.data = data.relabelled(self._repaired.extensions)
        self._usual = float(np.median(list(self._repaired.surprise.values()))) if noisy else 0.0
        self.unreliable = frozenset(p for p in noisy if self._repaired.surprise[p] > UNRELIABLE and p >= data.initial)

    def partition(self, predicates: Sequence[int]) -> Partition:
        classes = self._base
        seen = [p for p in predicates if p in self._exact]
        for p in predicates:
            if p not in self._exact:
                classes = self.refine(classes, seen, p)
                seen.append(p)
        return classes

    def refine(self, classes: Partition, predicates: Sequence[int], added: int) -> Partition:
        effects: dict[int, list[tuple[tuple[int, ...], int]]] = {}
        for (c, variables), effect in sorted(self._repaired.effects[added].items()):
            effects.setdefault(c, []).append((variables, effect))
        refined: list[TransitionClass] = []
        for cls in classes:
            found = effects.get(self._base_of[cls.first], ())
            refined.extend(self._with_effects(*self._with_bystanders(cls, found), added))
        return tuple(sorted(refined, key=lambda c: c.first))

    def _with_bystanders(self, cls: TransitionClass, effects: Effects) -> tuple[TransitionClass, Effects]:
        """The class with a variable for every bystander of the effects, and the effects in its variables."""
        own = len(self._base[self._base_of[cls.first]].types)
        position = {v: v for v in range(own)}
        for v in sorted({v for variables, _ in effects for v in variables if v >= own}):
            wanted = self._repaired.bystanders.types[v - own]
            if wanted not in cls.types[own:]:
                cls = self._with_bystander(cls, v - own)
            position[v] = own + cls.types[own:].index(wanted)
        return cls, [(tuple(position[v] for v in variables), effect) for variables, effect in effects]

    def _with_bystander(self, cls: TransitionClass, which: int) -> TransitionClass:
        objects = self._repaired.bystanders.objects
        demos = [self.data.transitions[m.transition].demo for m in cls.members]
        members = [
            Member(m.transition, (*m.objects, objects[d][which])) for m, d in zip(cls.members, demos, strict=True)
        ]
        types = (*cls.types, self._repaired.bystanders.types[which])
        return replace(cls, types=types, members=tuple(members), memo=Memo())

    def _with_effects(self, cls: TransitionClass, effects: Effects, p: int) -> Iterable[TransitionClass]:
        add: list[Lifted] = [(p, v) for v, effect in effects if effect == ADD]
        delete: list[Lifted] = [(p, v) for v, effect in effects if effect == DELETE]
        mixed = [v for v, effect in effects if effect == MIXED]
        if not mixed:
            if not add and not delete:
                return (cls,)
            return (replace(cls, add=(*cls.add, *add), delete=(*cls.delete, *delete)),)
        parts: dict[tuple[int, ...], list[int]] = {}
        for i, member in enumerate(cls.members):
            plus, minus = self.data.effects(p, member.transition)
            atoms = [tuple(member.objects[x] for x in v) for v in mixed]
            parts.setdefault(tuple((a in plus) - (a in minus) for a in atoms), []).append(i)
        return [
            replace(
                cls,
                add=(*cls.add, *add, *((p, v) for v, c in zip(mixed, change, strict=True) if c > 0)),
                delete=(*cls.delete, *delete, *((p, v) for v, c in zip(mixed, change, strict=True) if c < 0)),
                members=tuple(cls.members[i] for i in members),
                memo=Memo(),
            )
            for change, members in parts.items()
        ]

    def price(self, candidate: int) -> float:
        return self.data.cost(candidate) + DOUBT * self._repaired.surprise[candidate]

    def doubt(self, candidate: int) -> float:
        """As many wrong labels as candidates usually have are no reason to doubt one."""
        return max(0.0, self._repaired.surprise[candidate] - self._usual)

    def unexplained(self, classes: Partition, chosen: Sequence[int]) -> float:
        """The labels of a candidate are explained as well as they ever will be."""
        return self._repaired.surprise[chosen[-1]]

    def schemas(self, classes: Partition, predicates: Sequence[int]) -> list[Schema]:
        return [
            Schema(number, cls, tuple((p, v) for p in sorted(predicates) for v in self._required(cls, p)))
            for number, cls in enumerate(classes)
        ]

    def _required(self, cls: TransitionClass, p: int) -> list[tuple[int, ...]]:
        """The variables over which ``p`` is a precondition of ``cls``."""
        counts = cls.counts_before(self.data, p)
        n = len(cls.members)
        if p in self._exact:
            return [v for v, count in counts.items() if count == n]
        return [v for v, count in counts.items() if 2 * count > n and self._always(cls, p, v)]

    def _always(self, cls: TransitionClass, p: int, variables: tuple[int, ...]) -> bool:
        """Whether "true in every member" explains the labels as well as "true in a share of them" (BIC)."""
        belief = np.array([self._belief(p, m.transition, tuple(m.objects[v] for v in variables)) for m in cls.members])
        n = len(belief)
        shares = (np.arange(n) + 0.5) / n
        mixed = np.log(shares[:, None] * belief + (1 - shares[:, None]) * (1 - belief)).sum(1).max()
        return bool(np.log(belief).sum() >= mixed - 0.5 * np.log(n + 1))

    def _belief(self, p: int, transition: int, args: tuple[int, ...]) -> float:
        tr = self.data.transitions[transition]
        doubt = self._repaired.doubt[p].get((tr.demo, tr.step, args))
        if doubt is not None:
            return doubt
        return 1 - CONFIDENT if args in self.data.before(transition, p) else CONFIDENT
