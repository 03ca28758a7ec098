"""The robust learner: operators from labels that are sometimes wrong (method 5.7).

Transitions are first told apart by the given predicates. Those that a model labels are repaired before
(``seen_givens.py``); no label of a candidate takes part. Within this partition, a hidden Markov model estimates for
every other predicate how often its labels are wrong and what each class of transitions does to it. A class is split
only where a predicate's effect is significantly mixed; an atom is a precondition unless the members in which it does
not hold are more than its wrong labels explain. The shares of the published learner are not used; what was chosen
instead is in ``RobustSettings``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pix2pred.learning.labels.baum_welch import EffectKind
from pix2pred.learning.labels.hidden_markov import HiddenMarkovLabels
from pix2pred.learning.operators.lifted_types import fitting
from pix2pred.learning.operators.robust_settings import RobustSettings
from pix2pred.learning.operators.seen_givens import told_apart
from pix2pred.learning.operators.transition_class import (
    Lifted,
    Member,
    MemberCache,
    OperatorSchema,
    Partition,
    TransitionClass,
)
from pix2pred.learning.transitions import IndexedTable
from pix2pred.structs import FromVLM

RoleEffects = Sequence[tuple[tuple[int, ...], EffectKind]]
"""What a class does to a predicate's atoms, by the variables that the atoms are about."""


@dataclass(frozen=True, slots=True)
class Robust:
    """Learns operators that survive wrong labels."""

    settings: RobustSettings = field(default_factory=RobustSettings)

    def fit(self, data: IndexedTable) -> RobustOperators:
        """Infer the true values of everything that a model labelled."""
        return RobustOperators(data, self.settings)


class RobustOperators:
    """The operators of one data set, with labels replaced by their most probable values."""

    def __init__(self, data: IndexedTable, settings: RobustSettings) -> None:
        self._settings = settings
        given = range(data.initial)
        self._exact = [p for p in given if not isinstance(data.predicates[p].source, FromVLM)]
        noisy = [p for p in range(len(data.predicates)) if p not in set(self._exact)]
        data = data.with_goals_reached(set(noisy))
        self._base = told_apart(data, self._exact, [p for p in noisy if p < data.initial], settings)
        self._posterior = HiddenMarkovLabels(settings.labels, settings.roles).fit(data, self._base, noisy)
        self._base_of = {m.transition: c for c, cls in enumerate(self._base) for m in cls.members}
        self.data = data.relabelled(self._posterior.extensions)
        surprise = self._posterior.surprise
        self._misbound = max((surprise[p] for p in noisy if p < data.initial), default=0.0)
        self._usual = float(np.median(list(surprise.values()))) if noisy else 0.0
        self.unreliable = frozenset(p for p in surprise if surprise[p] > settings.unreliable and p >= data.initial)

    def partition(self, predicates: Sequence[int]) -> Partition:
        classes = self._base
        seen = list(range(self.data.initial))
        for p in predicates:
            if p >= self.data.initial:
                classes = self.refine(classes, seen, p)
                seen.append(p)
        return classes

    def refine(self, classes: Partition, predicates: Sequence[int], added: int) -> Partition:
        effects: dict[int, list[tuple[tuple[int, ...], EffectKind]]] = {}
        for (c, variables), effect in sorted(self._posterior.effects[added].items()):
            effects.setdefault(c, []).append((variables, effect))
        refined: list[TransitionClass] = []
        for cls in classes:
            found = effects.get(self._base_of[cls.first], ())
            wide, effects_here = self._with_bystanders(cls, found)
            for part in fitting(self.data, wide, added, [v for v, _ in effects_here]):
                own = [(v, effect) for v, effect in effects_here if self.data.fits(part.types, added, v)]
                refined.extend(self._with_effects(part, own, added))
        return tuple(sorted(refined, key=lambda c: c.first))

    def _with_bystanders(self, cls: TransitionClass, effects: RoleEffects) -> tuple[TransitionClass, RoleEffects]:
        """The class with a variable for every bystander of the effects, and the effects in its variables."""
        own = len(self._base[self._base_of[cls.first]].types)
        position = {v: v for v in range(own)}
        for v in sorted({v for variables, _ in effects for v in variables if v >= own}):
            wanted = self._posterior.bystanders.types[v - own]
            if wanted not in cls.types[own:]:
                cls = self._with_bystander(cls, v - own)
            position[v] = own + cls.types[own:].index(wanted)
        return cls, [(tuple(position[v] for v in variables), effect) for variables, effect in effects]

    def _with_bystander(self, cls: TransitionClass, which: int) -> TransitionClass:
        objects = self._posterior.bystanders.objects
        demos = [self.data.transitions[m.transition].demo for m in cls.members]
        members = [
            Member(m.transition, (*m.objects, objects[d][which])) for m, d in zip(cls.members, demos, strict=True)
        ]
        types = (*cls.types, self._posterior.bystanders.types[which])
        return replace(cls, types=types, members=tuple(members), memo=MemberCache())

    def _with_effects(self, cls: TransitionClass, effects: RoleEffects, p: int) -> Iterable[TransitionClass]:
        add: list[Lifted] = [(p, v) for v, effect in effects if effect is EffectKind.ADD]
        delete: list[Lifted] = [(p, v) for v, effect in effects if effect is EffectKind.DELETE]
        mixed = [v for v, effect in effects if effect is EffectKind.MIXED]
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
                memo=MemberCache(),
            )
            for change, members in parts.items()
        ]

    def price(self, candidate: int) -> float:
        return self.data.cost(candidate) + self._settings.doubt_price * self._posterior.surprise[candidate]

    def doubt(self, candidate: int) -> float:
        """As many wrong labels as candidates usually have are no reason to doubt one."""
        return max(0.0, self._posterior.surprise[candidate] - self._usual)

    def unexplained(self, classes: Partition, chosen: Sequence[int]) -> float:
        """The labels of a candidate are explained as well as they ever will be."""
        return self._posterior.surprise[chosen[-1]]

    def schemas(self, classes: Partition, predicates: Sequence[int]) -> list[OperatorSchema]:
        return [
            OperatorSchema(number, cls, tuple((p, v) for p in sorted(predicates) for v in self._required(cls, p)))
            for number, cls in enumerate(classes)
            if cls.skill not in self.data.failed
        ]

    def _required(self, cls: TransitionClass, p: int) -> list[tuple[int, ...]]:
        """The variables over which ``p`` is a precondition of ``cls``."""
        known = cls.memo.required
        if p not in known:
            counts, n = cls.counts_before(self.data, p), len(cls.members)
            if p in self._exact:
                known[p] = [v for v, count in counts.items() if count == n]
            else:
                known[p] = [v for v, count in counts.items() if 2 * count > n and self._always(cls, p, v)]
        return known[p]

    def _always(self, cls: TransitionClass, p: int, variables: tuple[int, ...]) -> bool:
        """Whether "true in every member" explains the labels as well as "true in a share of them" (BIC)."""
        belief = np.array([self._belief(p, m.transition, tuple(m.objects[v] for v in variables)) for m in cls.members])
        if any(v not in cls.skill_args for v in variables):  # which object that is was told by labels as well
            belief = np.clip(belief, self._misbound, 1 - self._misbound)
        n = len(belief)
        shares = (np.arange(n) + 0.5) / n
        mixed = np.log(shares[:, None] * belief + (1 - shares[:, None]) * (1 - belief)).sum(1).max()
        return bool(np.log(belief).sum() >= mixed - 0.5 * np.log(n + 1))

    def _belief(self, p: int, transition: int, args: tuple[int, ...]) -> float:
        tr = self.data.transitions[transition]
        belief = self._posterior.belief[p].get((tr.demo, tr.step, args))
        if belief is not None:
            return belief
        wrong = self._settings.confident
        return 1 - wrong if args in self.data.before(transition, p) else wrong
