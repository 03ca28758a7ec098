"""Solving with a perfect model, and naming the cause when something is wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import pytest

import burger_truth
from pix2pred.domains.burger import BurgerDomain
from pix2pred.domains.burger.environment import BurgerEnvironment
from pix2pred.domains.burger.truth import concept_value
from pix2pred.domains.burger.world import BurgerWorld
from pix2pred.execution import Solver, TruthOf
from pix2pred.learning import LearningSettings, learn_operators
from pix2pred.planning import AStar, GreedyBestFirst, Planner
from pix2pred.predicates import Labeller, LabelSettings
from pix2pred.structs import Atom, Episode, Failure, FromVLM, WorldModel
from pix2pred.structs.environment import SimulatedTask
from pix2pred.structs.views import View
from pix2pred.vlm.noise.oracle import NoisyOracle
from pix2pred.vlm.offline.prompt_format import KnownWord

WORDS = {"cooked": "cooked", "hand_free": "hand_empty"}


@cache
def model() -> WorldModel:
    table = burger_truth.true_table("more-stacks", WORDS)
    operators = learn_operators(table, LearningSettings(operators="cluster-and-intersect"))
    vocabulary = BurgerDomain().vocabulary("more-stacks")
    return WorldModel(vocabulary, tuple(c.predicate for c in table.pool), operators, "oracle")


@cache
def tasks() -> Sequence[SimulatedTask]:
    return BurgerDomain().tasks("more-stacks", 5, 2)


@dataclass(frozen=True)
class Lies:
    """Ground truth of a world, with some atoms answered wrongly."""

    world: BurgerWorld
    wrong: frozenset[str] = frozenset()

    def __call__(self, view: View, word: str, names: Sequence[str]) -> bool | None:
        truth = concept_value(self.world, WORDS[word], names)
        return truth != (f"{word}({', '.join(names)})" in self.wrong)


def solve(
    task: SimulatedTask,
    wrong: frozenset[str] = frozenset(),
    changed: WorldModel | None = None,
    know_truth: bool = True,
    planner: Planner | None = None,
) -> Episode:
    environment = BurgerDomain().environment(task.task, task.simulator)
    words = [KnownWord(w, ("patty",) if w == "cooked" else ("robot",), w, False) for w in WORDS]
    oracle = NoisyOracle(words, Lies(environment.world, wrong))
    solver = Solver(changed or model(), planner or Planner(GreedyBestFirst()), Labeller(oracle, LabelSettings()))
    return solver.solve(task.task, environment, _truth(environment) if know_truth else None)


def _truth(environment: BurgerEnvironment) -> TruthOf:
    def truth(atom: Atom) -> bool | None:
        assert isinstance(atom.predicate.source, FromVLM)
        return concept_value(environment.world, WORDS[atom.predicate.source.phrase], [o.name for o in atom.objects])

    return truth


def without(name: str) -> WorldModel:
    return replace(model(), operators=tuple(op for op in model().operators if op.name != name))


def test_perfect_labels_and_the_printed_operators_solve_both_kinds_of_task() -> None:
    for task, length in zip(tasks(), (25, 29), strict=True):
        episode = solve(task, planner=Planner(AStar()))
        assert episode.solved and episode.failure is None
        assert len(episode.steps) == len(episode.plan) == length
        assert all(step.status == "done" for step in episode.steps)


@pytest.mark.parametrize(
    ("wrong", "failure"), [({"cooked(patty1)"}, Failure.WRONG_LABEL), ({"hand_free(robot)"}, Failure.WRONG_LABEL)]
)
def test_a_wrong_label_is_recognised_by_planning_again_with_the_truth(wrong: set[str], failure: Failure) -> None:
    episode = solve(tasks()[0], frozenset(wrong))
    assert episode.failure == failure
    assert [e.split(" ")[0] for e in episode.label_errors] == [next(iter(wrong)).split(" ")[0]] or episode.label_errors


def test_a_missing_operator_is_no_plan() -> None:
    assert solve(tasks()[0], changed=without("Op2")).failure == Failure.NO_PLAN


def test_a_model_that_promises_too_much_is_wrong() -> None:
    """Placing a raw patty is said to be enough: the plan runs, the goal does not hold."""
    loose = tuple(
        replace(op, preconditions=frozenset(a for a in op.preconditions if a.predicate.name != "cooked"))
        for op in model().operators
    )
    episode = solve(tasks()[0], changed=replace(model(), operators=loose))
    assert episode.failure == Failure.WRONG_MODEL


def test_without_known_truth_the_cause_is_left_open() -> None:
    loose = tuple(
        replace(op, preconditions=frozenset(a for a in op.preconditions if a.predicate.name != "cooked"))
        for op in model().operators
    )
    episode = solve(tasks()[0], changed=replace(model(), operators=loose), know_truth=False)
    assert episode.failure in (Failure.UNDETERMINED, Failure.SKILL)


def test_a_search_budget_is_its_own_cause() -> None:
    assert solve(tasks()[0], planner=Planner(AStar(max_nodes=5))).failure == Failure.BUDGET
    assert solve(tasks()[0], planner=Planner(GreedyBestFirst(), max_operators=10)).failure == Failure.BUDGET


def test_labels_in_the_episode_are_those_the_plan_rests_on() -> None:
    episode = solve(tasks()[0])
    assert [str(a) for a in episode.labels] == ["hand_free(robot)"]


def test_truth_mapping_is_complete() -> None:
    mapping: Mapping[str, str] = WORDS
    assert {p.name for p in model().selected} == set(mapping)


@pytest.mark.parametrize("closed_loop", [False, True])
def test_a_goal_that_holds_already_needs_no_skill(closed_loop: bool) -> None:
    task = tasks()[0]
    bun = next(o for o in task.task.objects if o.name == "bottom_bun1")
    on_ground = next(p for p in model().vocabulary.initial if p.name == "OnGround")
    easy = SimulatedTask(replace(task.task, goal=(on_ground(bun),)), task.simulator)
    environment = BurgerDomain().environment(easy.task, easy.simulator)
    oracle = NoisyOracle([], Lies(environment.world))
    solver = Solver(model(), Planner(GreedyBestFirst()), Labeller(oracle, LabelSettings()), closed_loop)
    episode = solver.solve(easy.task, environment)
    assert episode.solved and episode.steps == ()
