"""Problems made in unified-planning, its own examples, are solved by the engine; its own validator checks the plans."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from extras import need

pytestmark = need("unified_planning", extra="planners")


def test_the_examples_of_unified_planning_are_solved() -> None:
    from unified_planning.engines import SequentialPlanValidator
    from unified_planning.engines.results import ValidationResultStatus
    from unified_planning.shortcuts import OneshotPlanner, get_environment
    from unified_planning.test.examples import get_example_problems

    from pix2pred.unified_planning_engine import Pix2predEngine

    get_environment().credits_stream = None
    examples = [e.problem for _, e in sorted(get_example_problems().items()) if hasattr(e.problem, "kind")]
    ours = [problem for problem in examples if Pix2predEngine.supports(problem.kind)]
    assert {"basic_exists", "complex_conditional", "basic_with_costs"} <= {p.name for p in ours} and len(ours) >= 15
    with OneshotPlanner(name="pix2pred") as planner:
        for problem in ours:
            plan = planner.solve(problem).plan
            assert SequentialPlanValidator().validate(problem, plan).status == ValidationResultStatus.VALID, (
                problem.name
            )
        with pytest.warns(UserWarning, match="no use for a time-out"):
            planner.solve(ours[0], timeout=1.0)


def test_a_problem_without_a_plan_says_so() -> None:
    from unified_planning.shortcuts import BoolType, Fluent, OneshotPlanner, Problem, get_environment

    import pix2pred.unified_planning_engine  # noqa: F401

    get_environment().credits_stream = None
    problem = Problem("none")
    light = Fluent("light", BoolType())
    problem.add_fluent(light, default_initial_value=False)
    problem.add_goal(light())
    with OneshotPlanner(name="pix2pred", params={"planner": "astar-lmcut"}) as planner:
        result = planner.solve(problem)
    assert result.plan is None and result.status.name == "UNSOLVABLE_PROVEN"


def test_the_lines_of_the_page_plan_for_a_problem_that_was_read_there() -> None:
    from unified_planning.io import PDDLReader
    from unified_planning.shortcuts import get_environment

    get_environment().credits_stream = None
    domain = "(define (domain d) (:requirements :strips :typing) (:types thing) (:predicates (on ?x - thing))"
    domain += " (:action turn-on :parameters (?x - thing) :precondition (not (on ?x)) :effect (on ?x)))"
    problem = "(define (problem p) (:domain d) (:objects a b - thing) (:init) (:goal (and (on a) (on b))))"
    page = (Path(__file__).parents[2] / "docs/planning.md").read_text(encoding="utf-8")
    (lines,) = [
        b for b in re.findall(r"^```python\n(.*?)^```", page, re.DOTALL | re.MULTILINE) if "OneshotPlanner" in b
    ]
    names = {"problem": PDDLReader().parse_problem_string(domain, problem)}
    exec(lines, names)
    assert [str(s) for s in names["result"].plan.actions] == ["turn-on(a)", "turn-on(b)"]
