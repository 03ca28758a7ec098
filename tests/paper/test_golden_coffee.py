"""Coffee with perfect labels: the printed operators and the selected predicates (method 10.3)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import coffee_truth
import golden
from pix2pred.domains.coffee import CoffeeDomain
from pix2pred.domains.coffee.classifiers import AboveCup, objects_of, true_atoms
from pix2pred.domains.coffee.demonstrator import all_filled
from pix2pred.domains.coffee.environment import CoffeeEnvironment
from pix2pred.domains.coffee.scenes import initial_world
from pix2pred.domains.coffee.vocabulary import GIVEN
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.execution.episode import open_loop
from pix2pred.execution.parameters import Parameters
from pix2pred.learning import LearningSettings, hill_climbing, learn_operators
from pix2pred.planning import AStar, Planner
from pix2pred.structs import LiftedAtom, Operator, PlanStatus, TruthTable

WORDS = {"CupReceivingLiquid": "cup_receiving", "JugFilled": "jug_filled", "JugInMachine": "jug_in_machine"}
SETTINGS = {"operators": "cluster-and-intersect", **CoffeeDomain().settings("three-cups")}


def _shape(op: Operator) -> tuple[object, ...]:
    def atoms(group: frozenset[LiftedAtom]) -> frozenset[tuple[str, ...]]:
        return frozenset((a.predicate.name.removesuffix("0"), *(v.name for v in a.variables)) for a in group)

    parameters = tuple((v.name, v.type.name) for v in op.parameters)
    skill = (op.skill.name, tuple(v.name for v in op.skill_args))
    return op.name, parameters, skill, atoms(op.preconditions), atoms(op.add), atoms(op.delete)


def _with_a_missed_label(table: TruthTable) -> TruthTable:
    """The last demonstration's final CupReceivingLiquid labelled false."""
    *others, last = table.demos
    (column,) = (i for i, a in enumerate(last.atoms) if a.predicate.name == "CupReceivingLiquid")
    values = last.values.copy()
    assert values[-1, column] == 1
    values[-1, column] = 0
    return replace(table, demos=(*others, replace(last, values=values)))


@pytest.mark.parametrize("seed", [0, 1])
def test_ten_of_the_printed_operators_are_learned_exactly(seed: int) -> None:
    learned = learn_operators(coffee_truth.true_table(WORDS, seed), LearningSettings.model_validate(SETTINGS))
    assert [_shape(op) for op in learned] == [_shape(op) for op in golden.load_operators("coffee")[:10]]
    assert [law for op in learned for law in op.broken_laws()] == []


def test_one_missed_label_gives_the_eleventh() -> None:
    table = _with_a_missed_label(coffee_truth.true_table(WORDS))
    learned = learn_operators(table, LearningSettings.model_validate(SETTINGS))
    assert [_shape(op) for op in learned] == [_shape(op) for op in golden.load_operators("coffee")]


@pytest.mark.parametrize("early_stop", ["level", "improvement"])
def test_the_printed_predicates_are_selected(early_stop: str) -> None:
    settings = LearningSettings.model_validate({**SETTINGS, "early_stop": early_stop})
    table = coffee_truth.true_table(WORDS)
    selection = hill_climbing(table, settings).run()
    assert {p.name for p in selection.selected} == set(WORDS)
    assert selection.steps[0].j > 5000 and selection.steps[-1].j < 200


def test_a_jug_above_no_cup_in_particular_gives_other_operators() -> None:
    table = coffee_truth.true_table(WORDS, above=AboveCup.NEAR)
    learned = learn_operators(table, LearningSettings.model_validate(SETTINGS))
    above = {"JugAboveCup", "RobotAboveCup"}
    for op in learned:
        changed = {a.predicate.name for a in op.add | op.delete}
        assert bool(above & changed) == (op.skill.name == "PourSomeLiquid")


@pytest.mark.parametrize(("cups", "length"), [(1, 5), (2, 6), (3, 7), (4, 11), (5, 15), (6, 19)])
@pytest.mark.parametrize("turned_away", [False, True])
def test_plans_have_the_computed_lengths_and_work(cups: int, length: int, turned_away: bool) -> None:
    operators = learn_operators(coffee_truth.true_table(WORDS), LearningSettings.model_validate(SETTINGS))
    world = initial_world(cups, scene_generator(0, Split.TASKS, cups, 0), turned_away)
    objects = objects_of(world)
    goal = all_filled(objects)
    found = Planner(AStar()).plan(operators, objects, true_atoms(world, GIVEN, AboveCup.ANYWHERE), goal)
    assert found.status == PlanStatus.SOLVED
    assert len(found.plan) == length + turned_away
    episode = CoffeeEnvironment(world, GIVEN, goal, AboveCup.ANYWHERE)
    outcome = open_loop(found.plan, episode, Parameters({}, np.random.default_rng(0)))
    assert outcome.goal_reached, outcome.detail
