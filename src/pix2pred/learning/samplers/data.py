"""What a sampler learns from: parameters that had an operator's effects, and parameters that did not (method 7).

The method takes negatives under every type-consistent grounding. Here the skill's arguments stay bound to the objects
the skill was run with, and only groundings whose preconditions held count: where an operator was not applicable, its
effects staying away says nothing about the parameters.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from pix2pred.structs import AbstractState, Action, Demo, GroundOperator, LabelledDemo, Object, Operator
from pix2pred.structs.samplers import Features

Rows = NDArray[np.float64]

MOST_NEGATIVES = 100_000


@dataclass(frozen=True, slots=True)
class SamplerData:
    """The examples that a sampler is fitted to, one row each.

    A row of ``inputs`` holds the features of the objects that the operator is bound to, the same row of ``params`` the
    skill's continuous parameters that worked there. ``bad_inputs`` and ``bad_params`` are what did not work.
    """

    inputs: Rows
    params: Rows
    bad_inputs: Rows
    bad_params: Rows


@dataclass(frozen=True, slots=True)
class _Tried:
    """One run of a skill: the scene before it, the ``action``, and the atoms that it ``added`` and ``deleted``.

    ``objects`` are all of the scene, ``features`` what is measured of them, ``before`` the atoms that were true.
    """

    features: Features
    objects: tuple[Object, ...]
    before: AbstractState
    action: Action
    added: AbstractState
    deleted: AbstractState


def input_row(features: Features, objects: Sequence[Object]) -> Rows:
    """The features of ``objects``, one after the other; an object whose type has none adds nothing.

    Raises ``ValueError`` when a feature is missing.
    """
    featured = [o for o in objects if o.type.features]
    missing = [o.name for o in featured if o not in features]
    if missing:
        raise ValueError(f"a sampler needs the features of {missing[0]}, and there are none")
    return np.array([value for item in featured for value in features[item]], dtype=float)


def sampler_data(operator: Operator, demos: Sequence[Demo], labelled: Sequence[LabelledDemo]) -> SamplerData:
    """The examples of one operator. ``labelled`` holds the labels of ``demos``, over the predicates of operators."""
    good, bad = list[tuple[Rows, Rows]](), list[tuple[Rows, Rows]]()
    for tried in _runs(operator, demos, labelled):
        params = np.array(tried.action.params, dtype=float)
        fixed = dict(zip(operator.skill_args, tried.action.objects, strict=True))
        bound = list(islice(operator.groundings(fixed, tried.objects), MOST_NEGATIVES))
        own = _explains(tried, bound)
        if own is not None:
            good.append((input_row(tried.features, own.objects), params))
        for ground in bound:
            happened = ground.add <= tried.added and ground.delete <= tried.deleted
            if not happened and ground.preconditions <= tried.before:
                bad.append((input_row(tried.features, ground.objects), params))
    d = operator.skill.dimension
    width = sum(len(v.type.features) for v in operator.parameters)
    return SamplerData(*_stack(good, width, d), *_stack(bad[:MOST_NEGATIVES], width, d))


def _runs(operator: Operator, demos: Sequence[Demo], labelled: Sequence[LabelledDemo]) -> Iterator[_Tried]:
    for demo, labels in zip(demos, labelled, strict=True):
        states = labels.abstract_states()
        for t, action in enumerate(demo.actions):
            if action.skill == operator.skill:
                before, after = states[t], states[t + 1]
                features = demo.states[t].features
                yield _Tried(features, demo.objects, before, action, after - before, before - after)


def _explains(tried: _Tried, bound: Sequence[GroundOperator]) -> GroundOperator | None:
    """The binding whose effects are exactly what changed; among several one whose preconditions held."""
    exact = [g for g in bound if g.add == tried.added and g.delete == tried.deleted]
    return next((g for g in exact if g.preconditions <= tried.before), exact[0] if exact else None)


def _stack(rows: Sequence[tuple[Rows, Rows]], width: int, dimension: int) -> tuple[Rows, Rows]:
    if not rows:
        return np.zeros((0, width)), np.zeros((0, dimension))
    return np.stack([x for x, _ in rows]), np.stack([p for _, p in rows])
