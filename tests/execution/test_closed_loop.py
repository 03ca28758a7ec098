"""Looking after every skill: regression through plans, planning again, giving up with a reason."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import burger_truth
from pix2pred.domains.burger import BurgerDomain
from pix2pred.domains.burger.disturbances import Disturbances
from pix2pred.domains.burger.environment import BurgerEnvironment
from pix2pred.domains.burger.truth import concept_value
from pix2pred.domains.burger.world import BurgerWorld
from pix2pred.execution import Solver
from pix2pred.execution.monitor import necessary_atoms
from pix2pred.learning import LearningSettings, learn_operators
from pix2pred.planning import GreedyBestFirst, Planner
from pix2pred.predicates import Labeller, LabelSettings
from pix2pred.structs import AbstractState, Episode, State, Turn, WorldModel
from pix2pred.structs.environment import SimulatedTask
from pix2pred.structs.views import View
from pix2pred.vlm import VLM, Answer, Request
from pix2pred.vlm.answers.store import AnswerStore
from pix2pred.vlm.answers.stored import StoredVLM
from pix2pred.vlm.noise.oracle import NoiseRates, NoisyOracle
from random_worlds.burger import random_worlds

WORDS = {"cooked": "cooked", "hand_free": "hand_empty"}


@cache
def model() -> WorldModel:
    table = burger_truth.true_table("more-stacks", WORDS)
    vocabulary = BurgerDomain().vocabulary("more-stacks")
    chosen = tuple(c.predicate for c in table.pool)
    operators = learn_operators(table, LearningSettings(operators="cluster-and-intersect"))
    return WorldModel(vocabulary, chosen, operators, "oracle")


@cache
def task() -> SimulatedTask:
    return BurgerDomain().tasks("more-stacks", 5, 1)[0]


@dataclass
class Watched(BurgerEnvironment):
    """Remembers which world every picture shows, so that an oracle can answer from pictures."""

    inner: BurgerEnvironment
    shown: dict[str, BurgerWorld] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.__dict__.update(self.inner.__dict__)

    def observe(self) -> State:
        state = super().observe()
        self.shown[state.pictures[0].image.digest] = self.world
        return state


def solve(
    *,
    closed_loop: bool,
    disturb: float = 0.0,
    flip: float = 0.0,
    wrong_first: frozenset[str] = frozenset(),
    around: Callable[[VLM], VLM] = lambda vlm: vlm,
) -> Episode:
    environment = Watched(BurgerDomain().environment(task().task, task().simulator, disturb))
    environment.observe()
    first = environment.world

    def truth(view: View, word: str, names: Sequence[str]) -> bool:
        world = environment.shown[view.picture.image.digest]
        value = concept_value(world, WORDS[word], names)
        return value != (world == first and f"{word}({', '.join(names)})" in wrong_first)

    oracle = around(NoisyOracle([], truth, NoiseRates(flip=flip), seed=1))
    solver = Solver(model(), Planner(GreedyBestFirst()), Labeller(oracle, LabelSettings(crops=False)), closed_loop)
    return solver.solve(task().task, environment)


def test_necessary_atoms_are_the_goal_regressed_through_the_plan() -> None:
    solver = Solver(
        model(),
        Planner(GreedyBestFirst()),
        Labeller(NoisyOracle([], lambda v, w, n: w == "hand_free"), LabelSettings()),
    )
    seen, result = solver.plan(task().task)
    needed = necessary_atoms(result.plan, task().task.goal)
    assert needed[-1] == frozenset(task().task.goal) and len(needed) == len(result.plan) + 1
    state: AbstractState = seen
    for atoms, step in zip(needed, result.plan, strict=False):
        assert atoms <= state and step.preconditions <= atoms
        for atom in atoms:  # each is needed: without it the rest of the plan is illegal or misses the goal
            assert not _works(result.plan[needed.index(atoms) :], state - {atom}, frozenset(task().task.goal))
        state = step.apply(state)


def _works(plan: Sequence[object], state: AbstractState, goal: AbstractState) -> bool:
    from pix2pred.planning import is_valid

    return is_valid(plan, state, goal)  # type: ignore[arg-type]


def test_without_trouble_looking_changes_nothing() -> None:
    episode = solve(closed_loop=True)
    assert episode.solved and episode.replans == 0 and len(episode.steps) == 25


def test_disturbances_break_open_loop_plans_and_replanning_mends_them() -> None:
    blind, looking = solve(closed_loop=False, disturb=0.2), solve(closed_loop=True, disturb=0.2)
    assert not blind.solved
    assert looking.solved and looking.replans >= 1


@dataclass
class Mortal:
    """A model behind a store that is interrupted after so many answers."""

    inner: VLM
    lives: int

    @property
    def name(self) -> str:
        return self.inner.name

    def answer(self, request: Request) -> Answer:
        if self.lives == 0:
            raise KeyboardInterrupt
        self.lives -= 1
        return self.inner.answer(request)


def test_an_interrupted_episode_with_wrong_labels_resumes_to_the_same_steps_and_bytes(tmp_path: Path) -> None:
    def run(folder: str, lives: int = 1000) -> Episode:
        def around(vlm: VLM) -> VLM:
            return Mortal(StoredVLM(vlm, AnswerStore(tmp_path / folder)), lives)

        return solve(closed_loop=True, disturb=0.1, flip=0.1, around=around)

    def kept(folder: str) -> dict[str, bytes]:
        files = sorted(p for p in (tmp_path / folder).rglob("*") if p.is_file())
        return {str(p.relative_to(tmp_path / folder)): p.read_bytes() for p in files}

    whole = run("whole")
    assert whole.questions and whole.replans, "the episode asks again and plans again, or the test shows nothing"
    for lives in (1, 9, 20):
        with pytest.raises(KeyboardInterrupt):
            run("parts", lives)
    assert run("parts") == whole == run("parts")
    assert kept("parts") == kept("whole")


def test_a_wrong_first_label_is_noticed_and_put_right() -> None:
    wrong = frozenset({"cooked(patty1)"})
    assert not solve(closed_loop=False, wrong_first=wrong).solved
    episode = solve(closed_loop=True, wrong_first=wrong)
    assert episode.solved and episode.replans >= 1


def test_a_failure_that_repeats_ends_the_episode_with_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    from pix2pred.structs.environment import Step, StepStatus

    monkeypatch.setattr(
        Watched, "execute", lambda self, action: Step(StepStatus.STUCK, "the robot does not move"), raising=False
    )
    episode = solve(closed_loop=True)
    assert not episode.solved
    assert "failed again" in episode.detail and "the robot does not move" in episode.detail
    assert [s.turn for s in episode.steps] == [Turn.FOLLOWED, Turn.REPEATED, Turn.REPEATED]


def test_disturbances_are_repeatable_and_keep_worlds_legal() -> None:
    for world in random_worlds(11, 20, 2):
        disturb = Disturbances(1.0, (3, 4))
        first = [disturb(world) for _ in range(5)]
        disturb.reset()
        assert [disturb(world) for _ in range(5)] == first
        for changed in first:
            assert BurgerWorld.from_dict(changed.to_dict()) == changed
            assert sorted(t.name for t in changed.things) == sorted(t.name for t in world.things)
            cells = [(t.cell, t.z) for t in changed.things if t.name != changed.held]
            assert len(cells) == len(set(cells))
            for thing in changed.things:
                assert thing.prepared == world.thing(thing.name).prepared


def test_disturbances_come_at_the_rate_asked_for() -> None:
    world = random_worlds(12, 1, 1)[0]
    disturb = Disturbances(0.3, (1,))
    changed = np.mean([disturb(world) != world for _ in range(600)])
    assert 0.22 < changed < 0.38
    assert all(Disturbances(0.0, (s,))(world) == world for s in range(20))
    with pytest.raises(ValueError, match="between 0 and 1"):
        Disturbances(1.5, (1,))
