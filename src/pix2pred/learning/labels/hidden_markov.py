"""Inferring true values along demonstrations: a two-state hidden Markov model per ground atom.

The true value of an atom is hidden; its label is wrong with the predicate's error rate; what a transition does to the
value depends on the transition's class and on the role the atom's objects have in it, and on nothing else. Error rates
and effects are estimated together by expectation maximisation (Baum-Welch; Rabiner 1989) over all demonstrations. Then
every effect is settled as none, add, delete or mixed by the Bayesian information criterion, and the labels are replaced
by the most probable values. A missing label says nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pix2pred.learning.labels.baum_welch import BaumWelch, EffectKind
from pix2pred.learning.labels.chains import Chains, blocks
from pix2pred.learning.operators.robust_settings import LabelModelSettings, RoleSettings
from pix2pred.learning.operators.roles import Bystanders, Role, Roles
from pix2pred.learning.operators.transition_class import Partition
from pix2pred.learning.transitions import NOTHING, Extension, IndexedTable, ObjectIds


@dataclass(frozen=True, slots=True)
class LabelPosterior:
    """The most probable values of the noisy predicates, with what the model believes about them.

    - ``extensions[p][demo][state]`` are the argument tuples of which predicate ``p`` is most probably true.
    - ``belief[p][demo, state, args]`` is the probability that the atom is true, where that is not near 0 or 1.
    - ``effects[p][c, variables]`` says what class ``c`` does to the atom over ``variables``, where it does something;
      variables beyond those of the class are ``bystanders`` (see ``Roles``).
    - ``surprise[p]`` is the share of labels that are wrong, or the outcome of a mixed effect that mostly goes the other
      way.
    """

    extensions: dict[int, list[list[Extension]]]
    belief: dict[int, dict[tuple[int, int, ObjectIds], float]]
    effects: dict[int, dict[Role, EffectKind]]
    surprise: dict[int, float]
    bystanders: Bystanders


@dataclass(frozen=True, slots=True)
class HiddenMarkovLabels:
    """The model of labels, with its settings."""

    settings: LabelModelSettings = field(default_factory=LabelModelSettings)
    roles: RoleSettings = field(default_factory=RoleSettings)

    def fit(
        self, data: IndexedTable, classes: Partition, noisy: Sequence[int], *, beyond: bool = False
    ) -> LabelPosterior:
        """Estimate errors and effects of the predicates ``noisy``; ``classes`` of transitions are made without them."""
        settings = self.settings
        bystanders = Bystanders((), ((),) * len(data.demos)) if beyond else Bystanders.of(data)
        roles = Roles(data, classes, bystanders, noisy, self.roles, beyond)
        nowhere = {p: [[NOTHING] * demo.states for demo in data.demos] for p in noisy}  # where no atom is ever true
        empty: LabelPosterior = LabelPosterior(nowhere, {p: {} for p in noisy}, {}, {}, bystanders)
        result = replace(empty, effects={p: {} for p in noisy}, surprise=dict.fromkeys(noisy, 0.0))
        guess, floor = settings.error_rate, 0.0
        chains = list(blocks(data, roles, noisy, settings.cells))
        for i in range(settings.passes):  # later ones take the pooled error rate as the prior and the least assumed
            rates: dict[int, float] = {}
            for block in chains:
                model = BaumWelch(block, roles.siblings(), roles.beyond(), settings, guess, floor)
                model.fit()
                rates.update(zip(block.predicates, model.rates.tolist(), strict=True))
                result.surprise.update(zip(block.predicates, model.surprise.tolist(), strict=True))
                if i == settings.passes - 1:
                    _store(model, block, data, roles, settings.doubt_margin, result)
            if rates:
                pooled = float(np.median(list(rates.values())))
                guess = floor = float(np.clip(pooled, settings.least_pooled_rate, settings.error_rate))
        return result


def _store(
    model: BaumWelch, chains: Chains, data: IndexedTable, roles: Roles, margin: float, result: LabelPosterior
) -> None:
    """Put values, beliefs and effects of this block's predicates into ``result``; beliefs within ``margin`` of 0 or 1
    are left out."""
    inside = chains.in_demonstration()
    for i, p in enumerate(chains.predicates):
        result.extensions[p] = [[NOTHING] * demo.states for demo in data.demos]
        result.belief[p] = {}
        changed = np.flatnonzero(model.effects[i])
        result.effects[p] = {roles.keys[k]: EffectKind(model.effects[i, k]) for k in changed}
    true: dict[tuple[int, int, int], list[ObjectIds]] = {}
    for i, t in np.argwhere(model.values & inside).tolist():
        p = chains.predicates[chains.owner[i]]
        for d, args in chains.where[i]:
            true.setdefault((p, d, t), []).append(args)
    for (p, d, t), found in true.items():
        result.extensions[p][d][t] = frozenset(found)
    doubted = abs(model.belief - 0.5) < 0.5 - margin
    for i, t in np.argwhere(doubted & inside).tolist():
        belief = float(model.belief[i, t])
        of_predicate = result.belief[chains.predicates[chains.owner[i]]]
        for d, args in chains.where[i]:
            of_predicate[d, t, args] = belief
