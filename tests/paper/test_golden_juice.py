"""Juice with perfect labels: the printed operators, their plans, and the novel goals (method 10.5, 14.1)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import pytest

import golden
import home_truth
from extras import need
from pix2pred.domains.home.world import World
from pix2pred.domains.juice import JuiceDomain
from pix2pred.domains.juice.truth import CONCEPTS, concept_value
from pix2pred.learning import LearningSettings, hill_climbing, learn_operators
from pix2pred.planning import OneByOne
from pix2pred.structs import Operator, TruthTable

pytestmark = need("mujoco", extra="sim")

DOMAIN = JuiceDomain()
WORDS = {
    "IsCup": "is_cup",
    "NearJuiceValve": "juice_region",
    "InsideWasteValveRegion": "waste_region",
    "OutsideJuiceMachine": "outside",
    "LidClosed": "lid_closed",
    "Functional": "functional",
    "JuiceMachineOpen": "lid_open",
    "IsPlastic": "is_plastic",
    "HasContents": "full",
}
OPPOSITE = {"lid_open": "lid_closed", "full": "empty"}
PREDICATES = home_truth.visual(DOMAIN, {n: CONCEPTS[OPPOSITE.get(c, c)].types for n, c in WORDS.items()})
BY_PREDICATE = {PREDICATES[name]: concept for name, concept in WORDS.items()}


def value(world: World, concept: str, names: Sequence[str]) -> bool:
    if concept in OPPOSITE:
        return not concept_value(world, OPPOSITE[concept], names)
    return concept_value(world, concept, names)


PUBLISHED = {**DOMAIN.settings("new-objects"), "operators": "cluster-and-intersect"}
SETTINGS = LearningSettings.model_validate(PUBLISHED)


@cache
def table(seed: int = 0) -> TruthTable:
    return home_truth.true_table(DOMAIN, BY_PREDICATE, value, seed)


@cache
def operators() -> tuple[Operator, ...]:
    return tuple(learn_operators(table(), SETTINGS))


@pytest.mark.parametrize("seed", [0, 1])
def test_the_printed_operators_are_learned_exactly(seed: int) -> None:
    """All but their numbers, which count the classes of wrong labels that the paper's demonstrations had in between."""
    learned = learn_operators(table(seed), SETTINGS)
    shapes = [home_truth.ordered(home_truth.shape(op)[1:]) for op in golden.load_operators("juice")]
    assert sorted(map(repr, (home_truth.ordered(home_truth.shape(op)[1:]) for op in learned))) == sorted(
        map(repr, shapes)
    )
    assert [op.name for op in learned] == ["Op0", "Op1", "Op2", "Op3", "Op5", "Op7", "Op9", "Op10"]
    assert [law for op in learned for law in op.broken_laws()] == []


def test_the_printed_predicates_are_selected_but_the_one_that_changes_nothing() -> None:
    """Functional bars no plan of any demonstration, so that J has no use for it."""
    selection = hill_climbing(table(), SETTINGS).run()
    assert {p.name for p in selection.selected} == set(PREDICATES) - {"Functional"}


@pytest.mark.parametrize(("family", "length"), [("novel-goal-1", 6), ("novel-goal-2", 7)])
@pytest.mark.parametrize("index", range(2))
def test_novel_goals_have_the_printed_lengths_and_are_reached(family: str, length: int, index: int) -> None:
    start = DOMAIN.start(family, 0, index)
    assert home_truth.planned_and_run(DOMAIN, start, operators(), BY_PREDICATE, value) == length


@pytest.mark.parametrize("family", ["new-objects", "new-background", "more-objects"])
@pytest.mark.parametrize("index", range(3))
def test_the_other_variants_are_solved(family: str, index: int) -> None:
    start = DOMAIN.start(family, 1, index)
    assert home_truth.planned_and_run(DOMAIN, start, operators(), BY_PREDICATE, value)


@pytest.mark.parametrize("index", range(3))
def test_a_party_of_fifty_skills_is_planned_one_juice_after_the_other_and_reached(index: int) -> None:
    """Ten skills a juice, which is all that the printed operators can need, with one cup for the waste of all five."""
    start = DOMAIN.start("party", 0, index)
    assert home_truth.planned_and_run(DOMAIN, start, operators(), BY_PREDICATE, value, OneByOne()) == 50


def test_the_robust_learner_learns_the_printed_operators_too() -> None:
    """And those of the rare classes, which it does not drop."""
    shapes = [
        {repr(home_truth.ordered(home_truth.shape(op)[1:])) for op in ops}
        for ops in (learn_operators(table(), LearningSettings()), golden.load_operators("juice"))
    ]
    assert shapes[1] < shapes[0] and len(shapes[0]) == len(shapes[1]) + 1


@pytest.mark.parametrize(("rate", "seed"), [(0.0, 0), (0.02, 1), (0.02, 2), (0.02, 3)])
def test_the_robust_learner_is_right_with_wrong_labels(rate: float, seed: int) -> None:
    found = hill_climbing(home_truth.with_wrong_labels(table(), rate, seed), LearningSettings()).run()
    assert {"LidClosed", "JuiceMachineOpen", "NearJuiceValve", "InsideWasteValveRegion"} <= {
        p.name for p in found.selected
    }
    for family in DOMAIN.families[:5]:
        assert home_truth.planned_and_run(DOMAIN, DOMAIN.start(family, seed, 0), found.operators, BY_PREDICATE, value)
