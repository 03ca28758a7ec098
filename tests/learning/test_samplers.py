"""Samplers of continuous parameters: what they learn from, how honest they are, how they are kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from extras import need
from pix2pred.learning.samplers import networks as samplers_torch
from pix2pred.learning.samplers.data import SamplerData, sampler_data
from pix2pred.learning.samplers.file import SamplerFileError, dump_samplers, load_samplers
from pix2pred.learning.samplers.learn import LearnedSampler, SamplerFitter, fit_gaussian, learn_samplers
from pix2pred.learning.samplers.networks import fit_networks
from pix2pred.structs import (
    Action,
    Demo,
    FromDomain,
    LabelledDemo,
    LiftedAtom,
    Object,
    Operator,
    Predicate,
    Skill,
    State,
    Type,
    Variable,
)
from pix2pred.structs.samplers import UniformSampler, clip_to_box

CUP, PAD = Type("cup", ("x",)), Type("pad", ("x",))
PUSH = Skill("Push", (CUP,), (0.0,), (1.0,))
ON, FREE = Predicate("On", (CUP, PAD), FromDomain()), Predicate("Free", (PAD,), FromDomain())
cup, pads = Object("cup", CUP), (Object("pad1", PAD), Object("pad2", PAD))
C, P = Variable("?x0", CUP), Variable("?x1", PAD)
OPERATOR = Operator(
    "Op0", (C, P), frozenset({LiftedAtom(FREE, (P,))}), frozenset({LiftedAtom(ON, (C, P))}), frozenset(), PUSH, (C,)
)


@pytest.fixture(autouse=True)
def short_training(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(samplers_torch, "REGRESSION_STEPS", 400)
    monkeypatch.setattr(samplers_torch, "CLASSIFICATION_STEPS", 600)


BOTH = [fit_gaussian, pytest.param(fit_networks, marks=need("torch", extra="torch"))]


def push(index: int, x: float, force: float, reached: str | None) -> tuple[Demo, LabelledDemo]:
    """One push of the cup from ``x``: it ends on a pad, or nowhere. Both pads are free before."""
    objects = (cup, *pads)
    features = {cup: (x,), pads[0]: (1.0,), pads[1]: (2.0,)}
    atoms = (FREE(pads[0]), FREE(pads[1]), ON(cup, pads[0]), ON(cup, pads[1]))
    values = np.array([[1, 1, 0, 0], [1, 1, reached == "pad1", reached == "pad2"]], dtype=np.int8)
    action = Action(PUSH, (cup,), (force,))
    goal = (ON(cup, pads[0]),)
    name = f"push{index}"
    states = (State((), features), State((), features))
    return Demo(name, objects, states, (action,), goal), LabelledDemo(name, objects, (action,), goal, atoms, values)


def data_of(pushes: Sequence[tuple[Demo, LabelledDemo]]) -> SamplerData:
    return sampler_data(OPERATOR, [d for d, _ in pushes], [lab for _, lab in pushes])


def band(count: int, seed: int = 0) -> SamplerData:
    """Pushes from x between 0 and 1 work when the force is within 0.1 of 0.2 + x / 2."""
    rng = np.random.default_rng(seed)
    made = []
    for i in range(count):
        x, force = float(rng.uniform()), float(rng.uniform())
        made.append(push(i, x, force, "pad1" if abs(force - 0.2 - x / 2) < 0.1 else None))
    return data_of(made)


def test_what_worked_is_positive_and_what_did_not_although_applicable_is_negative() -> None:
    data = data_of([push(0, 0.5, 0.3, "pad1"), push(1, 0.6, 0.9, None)])
    assert data.inputs.tolist() == [[0.5, 1.0]] and data.params.tolist() == [[0.3]]
    rows = sorted((*x, *p) for x, p in zip(data.bad_inputs.tolist(), data.bad_params.tolist(), strict=True))
    # the first push did not reach pad 2, the second reached neither
    assert rows == [(0.5, 2.0, 0.3), (0.6, 1.0, 0.9), (0.6, 2.0, 0.9)]


def test_where_an_operator_is_not_applicable_nothing_is_learned_of_parameters() -> None:
    demo, labels = push(0, 0.5, 0.3, None)
    values = labels.values.copy()
    values[:, :2] = 0  # no pad is free
    blocked = LabelledDemo(labels.name, labels.objects, labels.actions, labels.goal, labels.atoms, values)
    data = data_of([(demo, blocked)])
    assert not len(data.params) and not len(data.bad_params)


@pytest.mark.parametrize("fit", BOTH)
@pytest.mark.parametrize("count", [1, 3])
def test_a_few_equal_examples_give_a_narrow_bell_and_never_a_spike(fit: SamplerFitter, count: int) -> None:
    sampler = fit(data_of([push(i, 0.5, 0.4, "pad1") for i in range(count)]), PUSH.low, PUSH.high)
    rng = np.random.default_rng(0)
    features = {cup: (3.0,), pads[0]: (1.0,)}
    if fit is fit_gaussian:
        drawn = [sampler.sample(features, (cup, pads[0]), rng).params[0] for _ in range(300)]
        assert np.mean(drawn) == pytest.approx(0.4, abs=0.02) and 0.003 < np.std(drawn) < 0.1
    else:
        assert 0 <= sampler.sample(features, (cup, pads[0]), rng).params[0] <= 1


@pytest.mark.parametrize("fit", BOTH)
def test_learning_beats_drawing_evenly_where_the_good_force_depends_on_the_place(fit: SamplerFitter) -> None:
    sampler = fit(band(120), PUSH.low, PUSH.high)
    rng = np.random.default_rng(5)

    def hits(chosen: UniformSampler | LearnedSampler) -> int:
        good = 0
        for _ in range(200):
            x = float(rng.uniform())
            force = chosen.sample({cup: (x,), pads[0]: (1.0,)}, (cup, pads[0]), rng).params[0]
            good += abs(force - 0.2 - x / 2) < 0.1
        return good

    assert isinstance(sampler, LearnedSampler)
    even, learned = hits(UniformSampler(PUSH.low, PUSH.high)), hits(sampler)
    assert even < 70 and learned > 150, (even, learned)


def test_the_classifier_rejects_and_the_draw_says_how_often() -> None:
    data = band(120)
    sampler = fit_gaussian(data, PUSH.low, PUSH.high)
    rng = np.random.default_rng(0)
    draws = [sampler.sample({cup: (-1.0,), pads[0]: (1.0,)}, (cup, pads[0]), rng) for _ in range(100)]  # far off
    assert {d.sampler for d in draws} == {"gaussian"} and sum(d.rejections for d in draws) > 0
    never = LearnedSampler("gaussian", sampler.gaussian, sampler.validity, (2.0,), (3.0,), max_rejections=7)
    hopeless = never.sample({cup: (0.5,), pads[0]: (1.0,)}, (cup, pads[0]), rng)
    assert hopeless.rejections == 7 and hopeless.params == (2.0,)


def test_draws_keep_to_what_always_worked_where_something_else_sometimes_did() -> None:
    """Forces from 0.4 to 0.6 work, weaker ones every other time, stronger ones never."""
    rng = np.random.default_rng(1)
    forces = [float(f) for f in rng.uniform(0, 1, 60)]
    worked = [0.4 < f < 0.6 or (f <= 0.4 and i % 2 == 0) for i, f in enumerate(forces)]
    made = [push(i, 0.5, f, "pad1" if w else None) for i, (f, w) in enumerate(zip(forces, worked, strict=True))]
    sampler = fit_gaussian(data_of(made), PUSH.low, PUSH.high)
    features = {cup: (0.5,), pads[0]: (1.0,)}

    def sure(chosen: LearnedSampler) -> int:
        drawn = [chosen.sample(features, (cup, pads[0]), rng).params[0] for _ in range(100)]
        return sum(0.4 < f < 0.6 for f in drawn)

    likeliest, first = sure(sampler), sure(replace(sampler, choices=1))
    assert likeliest >= 75 and likeliest >= first + 15, (likeliest, first)


@pytest.mark.parametrize("each", [1, 6])
def test_parameters_that_worked_as_often_as_they_failed(each: int) -> None:
    inputs, params = np.full((each, 2), 0.5), np.full((each, 1), 0.3)
    sampler = fit_gaussian(SamplerData(inputs, params, inputs, params), PUSH.low, PUSH.high)
    assert (sampler.validity is None) == (each < 5)
    draw = sampler.sample({cup: (0.5,), pads[0]: (1.0,)}, (cup, pads[0]), np.random.default_rng(0))
    assert draw.params[0] == pytest.approx(0.3, abs=0.05)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.tuples(st.floats(-1e3, 1e3), st.floats(0, 1), st.booleans()), min_size=1, max_size=12),
    st.floats(-1e6, 1e6),
)
def test_every_draw_lies_in_the_box_whatever_was_seen(rows: list[tuple[float, float, bool]], x: float) -> None:
    made = [push(i, at, force, "pad1" if good else None) for i, (at, force, good) in enumerate(rows)]
    data = data_of([push(99, 0.0, 0.5, "pad1"), *made])
    sampler = fit_gaussian(data, PUSH.low, PUSH.high)
    draw = sampler.sample({cup: (x,), pads[0]: (1.0,)}, (cup, pads[0]), np.random.default_rng(0))
    assert 0 <= draw.params[0] <= 1 and draw.rejections <= 100


@pytest.mark.parametrize("fit", BOTH)
def test_samplers_are_kept_as_arrays_and_load_back_equal(fit: SamplerFitter, tmp_path: Path) -> None:
    pushes = [push(0, 0.5, 0.3, "pad1"), push(1, 0.6, 0.9, None), push(2, 0.2, 0.25, "pad1")]
    made = learn_samplers((OPERATOR,), [d for d, _ in pushes], [lab for _, lab in pushes], fit)
    content = dump_samplers(made)
    assert content == dump_samplers(made)
    path = tmp_path / "samplers.npz"
    path.write_bytes(content)
    loaded = load_samplers(path)
    assert dump_samplers(loaded) == content
    features = {cup: (0.4,), pads[0]: (1.0,)}
    draws = [
        s["Op0"].sample(features, (cup, pads[0]), np.random.default_rng(3)) for s in (made, loaded)
    ]  # fmt: skip
    assert draws[0] == draws[1]


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"\x80\x04K*."])
def test_files_that_are_no_samplers_are_refused(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "samplers.npz"
    path.write_bytes(content)
    with pytest.raises(SamplerFileError, match="cannot be read as samplers"):
        load_samplers(path)


def test_operators_over_photos_get_no_sampler() -> None:
    demo, labels = push(0, 0.5, 0.3, "pad1")
    photos = Demo(demo.name, demo.objects, (State(), State()), demo.actions, demo.goal)
    assert learn_samplers((OPERATOR,), [photos], [labels]) == {}


def test_what_is_no_number_becomes_the_middle_of_the_box() -> None:
    assert clip_to_box(np.array([np.nan, 5.0, -np.inf]), (0, 0, 0), (2, 1, 1)) == (1.0, 1.0, 0.0)
