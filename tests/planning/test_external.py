"""External engines: the same costs as ours, honest outcomes, and nothing left running."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from extras import need
from pix2pred.cli.app import run
from pix2pred.planning import AStar, ExternalPlanner, ExternalPlannerError, Planner, is_valid
from pix2pred.planning.external import planner as external
from pix2pred.planning.pddl.read import PddlDomain, PddlProblem, read_domain, read_problem
from pix2pred.registry import load_planner
from pix2pred.structs import PlanResult, PlanStatus
from pix2pred.system.extras import install_command
from planning.test_cross_check import FOLDER, PROBLEMS

with_planners = need("unified_planning", "up_fast_downward", "up_pyperplan", extra="planners")

TWO = (
    "(define (domain d) (:requirements :strips :typing :equality) (:types red - ball ball - object)"
    " (:predicates (p ?a - ball) (q ?a - ball ?b - object))"
    " (:action join :parameters (?a - ball ?b - object) :precondition (and (p ?a) (not (= ?a ?b))) :effect (q ?a ?b)))"
)


def load(domain: str, problem: str) -> tuple[PddlDomain, PddlProblem]:
    read = read_domain((FOLDER / f"{domain}-domain.pddl").read_text())
    return read, read_problem((FOLDER / f"{problem}.pddl").read_text(), read)


def two(objects: str, goal: str) -> tuple[PddlDomain, PddlProblem]:
    read = read_domain(TWO)
    text = f"(define (problem x) (:domain d) (:objects {objects}) (:init (p a)) (:goal {goal}))"
    return read, read_problem(text, read)


def solve(planner: Any, domain: PddlDomain, task: PddlProblem) -> PlanResult:
    found: PlanResult = planner.plan(domain.operators, task.objects, task.initial, task.goal)
    return found


@with_planners
@pytest.mark.parametrize(("domain", "problem"), PROBLEMS, ids=[p for _, p in PROBLEMS])
def test_optimal_costs_agree_with_fast_downward(domain: str, problem: str) -> None:
    read, task = load(domain, problem)
    ours = solve(Planner(AStar(), distinct=read.distinct), read, task)
    theirs = solve(ExternalPlanner("fast-downward-opt", read.distinct), read, task)
    assert theirs.status == PlanStatus.SOLVED
    assert is_valid(theirs.plan, task.initial, task.goal)
    assert len(theirs.plan) == len(ours.plan)
    assert theirs.nodes is None


@with_planners
@pytest.mark.parametrize("engine", ["fast-downward", "fast-downward-opt", "pyperplan", "pyperplan-opt"])
def test_distinct_parameters_and_subtypes_reach_every_engine(engine: str) -> None:
    for objects, goal, status in [
        ("a - red", "(q a a)", "unsolvable"),
        ("a - red b - ball", "(q a b)", "solved"),
        ("a - ball b - object", "(q a b)", "solved"),
    ]:
        read, task = two(objects, goal)
        assert read.distinct
        found = solve(load_planner(engine, distinct=True), read, task)
        wanted = {status} if status == "solved" else {"unsolvable", "not found"}
        assert found.status in wanted
        assert len(found.plan) == (status == "solved")


@with_planners
def test_coinciding_parameters_where_they_are_allowed() -> None:
    read, task = two("a - red", "(q a a)")
    assert solve(ExternalPlanner("fast-downward", distinct=False), read, task).status == PlanStatus.SOLVED


@with_planners
def test_the_command_prints_the_competition_form(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    files = [str(FOLDER / "juice-domain.pddl"), str(FOLDER / "juice-novel1.pddl")]
    out = tmp_path / "plan.txt"
    assert run(["plan-pddl", *files, "--planner", "fast-downward", "--out", str(out)]) == 0
    printed = capfd.readouterr().out.splitlines()
    assert out.read_text().splitlines() == printed[:-1]
    assert all(line.startswith("(strips-op") for line in printed[:-1])
    assert "nodes unknown" in printed[-1]
    assert run(["plan-pddl", *files, "--planner", "pyperplan-opt", "--json"]) == 0
    answer = json.loads(capfd.readouterr().out.splitlines()[-1])
    assert answer["nodes"] is None and answer["status"] == "solved"


def test_a_missing_engine_names_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(external, "find_spec", lambda _: None)
    files = [str(FOLDER / "juice-domain.pddl"), str(FOLDER / "juice-novel1.pddl")]
    assert run(["plan-pddl", *files, "--planner", "fast-downward"]) == 2
    assert f"{install_command('planners')}\n" in capsys.readouterr().err
    assert run(["plan-pddl", *files, "--planner", "symk"]) == 2
    assert f"{install_command('planners')} up-symk" in capsys.readouterr().err


class TestAnswersOfTheProgram:
    """What the planner makes of each way the engine's program can end; the program is a stand-in."""

    def planner(self, monkeypatch: pytest.MonkeyPatch, code: str, time_limit: float = 60) -> ExternalPlanner:
        real = subprocess.Popen

        def stand_in(_command: list[str], **options: Any) -> Any:
            return real([sys.executable, "-c", code], **options)

        monkeypatch.setattr(external, "find_spec", lambda _: True)
        monkeypatch.setattr(subprocess, "Popen", stand_in)
        return ExternalPlanner("fast-downward", time_limit=time_limit)

    def answer(self, status: str, plan: list[list[int]] | None = None) -> str:
        return f"print('chatter'); print({json.dumps({'status': status, 'plan': plan or [], 'message': 'why'})!r})"

    @pytest.mark.parametrize(
        ("status", "outcome"),
        [
            ("UNSOLVABLE_PROVEN", PlanStatus.UNSOLVABLE),
            ("UNSOLVABLE_INCOMPLETELY", PlanStatus.NOT_FOUND),
            ("TIMEOUT", PlanStatus.TIMEOUT),
            ("MEMOUT", PlanStatus.BUDGET),
        ],
    )
    def test_failures_stay_apart(self, monkeypatch: pytest.MonkeyPatch, status: str, outcome: PlanStatus) -> None:
        found = solve(self.planner(monkeypatch, self.answer(status)), *two("a b - ball", "(q a b)"))
        assert (found.status, found.plan, found.nodes) == (outcome, (), None)

    def test_a_plan_comes_back_in_our_operators(self, monkeypatch: pytest.MonkeyPatch) -> None:
        code = self.answer("SOLVED_SATISFICING", [[0, 0, 1]])
        found = solve(self.planner(monkeypatch, code), *two("a b - ball", "(q a b)"))
        assert [(s.operator.name, *(o.name for o in s.objects)) for s in found.plan] == [("join", "a", "b")]

    @pytest.mark.parametrize(
        ("code", "message"),
        [
            ("import sys; sys.exit('ValueError: no')", "fast-downward failed: ValueError: no"),
            ("import sys; sys.exit(3)", "fast-downward failed: exit code 3"),
            ("pass", "fast-downward failed: exit code 0"),
            ("print('{\"status\"')", "fast-downward failed: its answer cannot be read"),
        ],
    )
    def test_crashes_are_errors(self, monkeypatch: pytest.MonkeyPatch, code: str, message: str) -> None:
        with pytest.raises(ExternalPlannerError, match=message):
            solve(self.planner(monkeypatch, code), *two("a b - ball", "(q a b)"))

    def test_an_engine_that_fails_says_why(self, monkeypatch: pytest.MonkeyPatch) -> None:
        with pytest.raises(ExternalPlannerError, match="UNSUPPORTED_PROBLEM: why"):
            solve(self.planner(monkeypatch, self.answer("UNSUPPORTED_PROBLEM")), *two("a b - ball", "(q a b)"))

    def test_a_wrong_plan_is_not_passed_on(self, monkeypatch: pytest.MonkeyPatch) -> None:
        code = self.answer("SOLVED_SATISFICING", [[0, 1, 0]])
        with pytest.raises(ExternalPlannerError, match="a plan that does not work"):
            solve(self.planner(monkeypatch, code), *two("a b - ball", "(q a b)"))

    def test_time_limit(self, monkeypatch: pytest.MonkeyPatch) -> None:
        planner = self.planner(monkeypatch, "import time; time.sleep(600)", time_limit=0.5)
        found = solve(planner, *two("a b - ball", "(q a b)"))
        assert (found.status, found.plan) == (PlanStatus.TIMEOUT, ())
        assert found.seconds < 60
