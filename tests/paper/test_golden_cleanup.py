"""Cleanup with perfect labels: the printed operators, their plans, and the novel goals (method 10.4, 14.1)."""

from __future__ import annotations

from functools import cache

import pytest

import golden
import home_truth
from extras import need
from pix2pred.domains.cleanup import CleanupDomain
from pix2pred.domains.cleanup.truth import concept_value
from pix2pred.learning import LearningSettings, hill_climbing, learn_operators
from pix2pred.planning import OneByOne
from pix2pred.structs import Operator, TruthTable

pytestmark = need("mujoco", extra="sim")

DOMAIN = CleanupDomain()
PREDICATES = home_truth.visual(
    DOMAIN,
    {
        "IsOnFloor": ("movable_object",),
        "IsEraser": ("movable_object",),
        "NoObjectsOnTop": ("table",),
        "IsOn": ("movable_object", "table"),
    },
)
CONCEPTS = {
    PREDICATES["IsOnFloor"]: "on_floor",
    PREDICATES["IsEraser"]: "is_eraser",
    PREDICATES["NoObjectsOnTop"]: "clear",
    PREDICATES["IsOn"]: "on_table",
}
PUBLISHED = {**DOMAIN.settings("new-objects"), "operators": "cluster-and-intersect"}
SETTINGS = LearningSettings.model_validate(PUBLISHED)


@cache
def table(seed: int = 0) -> TruthTable:
    return home_truth.true_table(DOMAIN, CONCEPTS, concept_value, seed)


@cache
def operators() -> tuple[Operator, ...]:
    return tuple(learn_operators(table(), SETTINGS))


@pytest.mark.parametrize("seed", [0, 1])
def test_the_printed_operators_are_learned_exactly(seed: int) -> None:
    learned = learn_operators(table(seed), SETTINGS)
    assert [home_truth.shape(op) for op in learned] == [home_truth.shape(op) for op in golden.load_operators("cleanup")]
    assert [law for op in learned for law in op.broken_laws()] == []


def test_the_printed_predicates_are_selected() -> None:
    selection = hill_climbing(table(), SETTINGS).run()
    assert {p.name for p in selection.selected} == set(PREDICATES)


@pytest.mark.parametrize(("family", "length"), [("novel-goal-1", 5), ("novel-goal-2", 6)])
@pytest.mark.parametrize("index", range(2))
def test_novel_goals_have_the_printed_lengths_and_are_reached(family: str, length: int, index: int) -> None:
    start = DOMAIN.start(family, 0, index)
    assert home_truth.planned_and_run(DOMAIN, start, operators(), CONCEPTS, concept_value) == length


@pytest.mark.parametrize("family", ["new-objects", "new-background", "more-objects"])
@pytest.mark.parametrize("index", range(3))
def test_the_other_variants_are_solved(family: str, index: int) -> None:
    start = DOMAIN.start(family, 1, index)
    assert home_truth.planned_and_run(DOMAIN, start, operators(), CONCEPTS, concept_value)


@pytest.mark.parametrize("index", range(3))
def test_many_things_are_cleared_one_after_the_other_and_the_eraser_is_put_away_last(index: int) -> None:
    """As many skills as a shortest plan has."""
    start = DOMAIN.start("many", 0, index)
    assert home_truth.planned_and_run(DOMAIN, start, operators(), CONCEPTS, concept_value, OneByOne()) == 31


def test_the_robust_learner_learns_the_printed_operators_too() -> None:
    """And those of the rare classes, which it does not drop."""
    shapes = [
        {repr(home_truth.ordered(home_truth.shape(op)[1:])) for op in ops}
        for ops in (learn_operators(table(), LearningSettings()), golden.load_operators("cleanup"))
    ]
    assert shapes[1] < shapes[0] and len(shapes[0]) == len(shapes[1]) + 1


@pytest.mark.parametrize(("rate", "seed"), [(0.0, 0), (0.02, 1), (0.02, 2), (0.02, 3)])
def test_the_robust_learner_is_right_with_wrong_labels(rate: float, seed: int) -> None:
    found = hill_climbing(home_truth.with_wrong_labels(table(), rate, seed), LearningSettings()).run()
    assert {p.name for p in found.selected} == set(PREDICATES)
    for family in DOMAIN.families[:5]:
        assert home_truth.planned_and_run(
            DOMAIN, DOMAIN.start(family, seed, 0), found.operators, CONCEPTS, concept_value
        )
