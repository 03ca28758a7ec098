"""ViLa and VLM feature predicates, end to end on answers written by hand: good, malformed, partly right."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from approaches import recorded
from pix2pred.approaches.approach import Training
from pix2pred.approaches.sandbox import SandboxLimits
from pix2pred.approaches.vila_fewshot import VILA_FEWSHOT
from pix2pred.approaches.vila_pure import VILA_PURE
from pix2pred.approaches.vlm_feature_predicates import CodeAgent, VLMFeaturePredicates
from pix2pred.domains.burger import BurgerDomain
from pix2pred.pipeline import LearningProblem
from pix2pred.registry import load_planner
from pix2pred.settings import Settings
from pix2pred.structs import Demo, Episode, Failure
from pix2pred.structs.environment import SimulatedTask
from pix2pred.vlm import VLM, ReplayMissError, Request

FAMILY = "more-stacks"
CODE = replace(VLMFeaturePredicates(), limits=SandboxLimits(steps=100_000))


@cache
def demos() -> tuple[Demo, ...]:
    return tuple(BurgerDomain().demonstrations(FAMILY, 0)[1:4])


@cache
def tasks(items: int) -> tuple[SimulatedTask, ...]:
    return tuple(BurgerDomain().sized_tasks(FAMILY, 0, 2, items))


def training(vlm: VLM, shown: int | None = None) -> Training:
    vocabulary = BurgerDomain().vocabulary(FAMILY)
    settings = Settings.model_validate({"learning": {"max_plans": 5, "node_budget": 2_000}})
    return Training(LearningProblem(vocabulary, demos(), vlm, settings), load_planner("portfolio"), shown)


def plan_of(quality: str) -> Callable[[Request], str]:
    def answer(request: Request) -> str:
        two_burgers = "- patty2" in request.text or "patty2: patty" in request.text
        return recorded.text(f"vila_{quality}_{2 if two_burgers else 1}")

    return answer


def episode(approach: object, vlm: VLM, task: SimulatedTask) -> Episode:
    agent = approach.train(training(vlm, shown=2))  # type: ignore[attr-defined]
    solved: Episode = agent.solve(task.task, BurgerDomain().environment(task.task, task.simulator), None)
    return solved


@pytest.mark.parametrize("approach", [VILA_PURE, VILA_FEWSHOT], ids=lambda a: a.name)
@pytest.mark.parametrize(
    ("quality", "items", "failure", "executed"),
    [
        ("good", 2, None, 5),
        ("good", 4, None, 10),
        ("malformed", 2, Failure.NO_PLAN, 0),
        ("malformed", 4, Failure.NO_PLAN, 0),
        ("partly", 2, None, 5),
        ("partly", 4, Failure.UNDETERMINED, 5),
    ],
)
def test_vila_end_to_end(
    approach: object, quality: str, items: int, failure: Failure | None, executed: int, tmp_path: Path
) -> None:
    task = tasks(items)[0]
    first = episode(approach, recorded.recording(tmp_path, plan_of(quality)), task)
    assert (first.failure, len(first.steps)) == (failure, executed)
    assert episode(approach, recorded.replay(tmp_path), task) == first


def test_why_a_plan_failed_is_told(tmp_path: Path) -> None:
    def why(quality: str, items: int) -> str:
        return episode(VILA_PURE, recorded.recording(tmp_path / quality, plan_of(quality)), tasks(items)[0]).detail

    assert "no line 'Plan:'" in why("malformed", 2)
    assert "no skill is called 'Grab'" in why("malformed", 4)
    assert "Serve the burger: a bracket is missing" in why("partly", 4)


def test_few_shot_asks_another_question_than_pure(tmp_path: Path) -> None:
    episode(VILA_PURE, recorded.recording(tmp_path, plan_of("good")), tasks(2)[0])
    with pytest.raises(ReplayMissError):
        episode(VILA_FEWSHOT, recorded.replay(tmp_path), tasks(2)[0])


def code_agent(quality: str, folder: Path) -> CodeAgent:
    vlm = recorded.recording(folder, lambda request: recorded.text(f"code_{quality}"))
    first = CODE.train(training(vlm))
    again = CODE.train(training(recorded.replay(folder)))
    assert again.summary == first.summary
    return again


def solve(agent: CodeAgent, task: SimulatedTask) -> Episode:
    return agent.solve(task.task, BurgerDomain().environment(task.task, task.simulator), None)


@pytest.mark.parametrize("quality", ["good", "partly"])
def test_feature_predicates_written_by_a_model_are_selected_and_planned_with(quality: str, tmp_path: Path) -> None:
    agent = code_agent(quality, tmp_path)
    assert "HandFree0" in agent.summary["selected"]
    for task in tasks(1):
        assert solve(agent, task).solved


def test_one_bad_predicate_costs_nothing_but_itself(tmp_path: Path) -> None:
    """One block of seven is used. At a bad indentation the parser looks for the file, which kills the process."""
    agent = code_agent("partly", tmp_path)
    reasons = list(agent.summary["rejected"])
    assert agent.summary["written"] == 1
    for expected in ("Import", "__subclasses__", "'temperature'", "steps", "SIGSYS", "NameError"):
        assert sum(expected in reason for reason in reasons) >= 1, (expected, reasons)


def test_an_answer_without_a_usable_block_leaves_the_given_predicates(tmp_path: Path) -> None:
    agent = code_agent("malformed", tmp_path)
    assert agent.summary["selected"] == [] and agent.summary["written"] == 0
    assert any("spoon" in r for r in agent.summary["rejected"])
    for task in tasks(2):
        assert not solve(agent, task).solved


def test_code_sees_features_alone(tmp_path: Path) -> None:
    """Neither given atoms nor hidden simulator state nor pictures reach the classifiers."""
    agent = code_agent("good", tmp_path)
    task = tasks(1)[0].task
    blind = replace(task.initial, pictures=(), given=frozenset())
    (seen,) = agent.pool.values([blind], task.objects, SandboxLimits())
    assert {str(a) for a in seen.given} == {"HandFree0(robot)"}
