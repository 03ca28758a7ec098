"""Traces in, model out; and planning for its own sake."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import pytest

from command_line import Cli
from pix2pred.learning import LearningSettings

DATA = Path(__file__).parents[1] / "data"
WORKLOAD = DATA / "workloads" / "more_stacks_n100_noise2.json.gz"
COOKED = {"Cooked_patty", "Grilled_patty", "FullyCooked_patty", "Done_patty", "Prepared_patty", "ReadyToServe_patty"}
HAND_FREE = {"Available_robot", "EmptyHanded_robot", "Free_robot", "NotHolding_robot", "Busy_robot"}


def test_the_supplied_workload_gives_the_needed_meanings(cli: Cli, tmp_path: Path) -> None:
    ran = cli("select", WORKLOAD, "--out", tmp_path / "selection.json", "--pddl", tmp_path / "pddl", "--json")
    assert ran.code == 0, ran.err
    written = json.loads((tmp_path / "selection.json").read_text())
    assert {k: v for k, v in ran.json.items() if k != "seconds"} == written
    first, second = written["selected"]
    assert first in COOKED and second in HAND_FREE
    assert [s["added"] for s in written["steps"]] == [None, first, second]
    assert written["evaluations"] == 174  # of 98 candidates in two steps, without those whose labels make no sense
    assert written["settings"]["precondition_rule"] == "more_than"
    assert {"cpu", "wall", "scored"} == set(json.loads((tmp_path / "timings.json").read_text()))
    score = cli("select", WORKLOAD, "--out", tmp_path / "s.json", "--score", "Cooked_patty,Available_robot", "--json")
    assert written["steps"][-1]["J"] <= 1.15 * score.json["J"]
    for problem in ("demo-0", "demo-11"):
        plan = cli("plan-pddl", tmp_path / "pddl" / "domain.pddl", tmp_path / "pddl" / f"{problem}.pddl", "--json")
        assert plan.code == 0 and len(plan.json["plan"]) == (14 if problem == "demo-0" else 7)


def test_tie_seeds_give_a_range_around_the_default_engine(cli: Cli, tmp_path: Path) -> None:
    ran = cli("select", WORKLOAD, "--out", tmp_path / "s.json", "--score", "Cooked_patty", "--tie-seeds", 9, "--json")
    spread = ran.json["J_over_tie_seeds"]
    assert spread["minimum"] <= spread["median"] <= spread["maximum"]
    assert 0.9 * spread["minimum"] <= ran.json["J"] <= 1.1 * spread["maximum"]


def test_options_override_the_file(cli: Cli, tmp_path: Path) -> None:
    args = ("--early-stop", "improvement", "--h-pre-frac", 0.7, "--precondition-rule", "at_least", "--json")
    ran = cli("select", WORKLOAD, "--out", tmp_path / "s.json", *args)
    assert ran.json["settings"]["early_stop"] == "improvement"
    assert ran.json["settings"]["h_pre_frac"] == 0.7


def test_every_setting_is_an_option_and_a_wrong_value_is_named(cli: Cli, tmp_path: Path) -> None:
    ran = cli("select", WORKLOAD, "--out", tmp_path / "s.json", "--h-pre-frac", 7)
    assert "--h-pre-frac: Input should be less than or equal to 1, found '7'" in ran.err and ran.code == 2
    shown = cli("select", "--help").out
    assert all(f"--{name.replace('_', '-')}" in shown for name in LearningSettings.model_fields)


def _broken(change: str) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(gzip.decompress(WORKLOAD.read_bytes()))
    match change:
        case "object":
            data["demos"][0]["actions"][0][2] = "patty9"
        case "setting":
            data["settings"]["h_pre_frac"] = 7
        case "key":
            data["predicats"] = []
        case "goal":
            data["demos"][1]["goal"][0] = ["Cooked_patty", "patty1"]
    return data


@pytest.mark.parametrize(
    ("change", "path"),
    [("object", "$.demos[0].actions[0]"), ("setting", "$.settings.h_pre_frac"), ("key", "$.predicats"),
     ("goal", "$.demos[1].goal[0]")],
)  # fmt: skip
def test_errors_name_the_json_path(cli: Cli, tmp_path: Path, change: str, path: str) -> None:
    file = tmp_path / "traces.json"
    file.write_text(json.dumps(_broken(change)))
    ran = cli("select", file, "--out", tmp_path / "s.json")
    assert ran.code == 2 and path in ran.err and "Traceback" not in ran.err
    assert not (tmp_path / "s.json").exists()


def test_scoring_an_unknown_candidate_suggests_one(cli: Cli, tmp_path: Path) -> None:
    ran = cli("select", WORKLOAD, "--out", tmp_path / "s.json", "--score", "Coked_patty")
    assert ran.code == 2 and "did you mean 'Cooked_patty'" in ran.err


@pytest.mark.parametrize("planner", ["gbfs-ff", "astar-lmcut", "portfolio"])
def test_every_published_problem_is_solved(cli: Cli, tmp_path: Path, planner: str) -> None:
    for problem in sorted((DATA / "pddl").glob("*.pddl")):
        if problem.stem.endswith("-domain"):
            continue
        text = problem.read_text()
        domain = DATA / "pddl" / f"{text.split(':domain ')[1].split(')')[0]}-domain.pddl"
        out = tmp_path / f"{problem.stem}.plan"
        ran = cli("plan-pddl", domain, problem, "--planner", planner, "--out", out, "--json")
        assert ran.code == 0, (problem, ran.err)
        assert out.read_text().splitlines() == ran.json["plan"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("(clear ?x1)", "(claer ?x1)", "line 18, column 36: predicate claer"),
        ("- patty ?x1 - robot)", "- patti ?x1 - robot)", "line 17, column 23: type patti"),
        (":precondition (and (clear ?x0)", ":precondition (and (clear ?x7)", "line 18, column 30: ?x7"),
        ("(define (domain", "(define (domain (", "parenthesis"),
    ],
)
def test_pddl_errors_name_the_line(cli: Cli, tmp_path: Path, old: str, new: str, message: str) -> None:
    text = (DATA / "pddl" / "more-stacks-burger-domain.pddl").read_text()
    assert old in text
    broken = tmp_path / "domain.pddl"
    broken.write_text(text.replace(old, new, 1))
    ran = cli("plan-pddl", broken, DATA / "pddl" / "stacks-train1.pddl")
    assert ran.code == 2 and message in ran.err and str(broken) in ran.err


def test_an_unsolvable_problem_exits_with_1(cli: Cli, tmp_path: Path) -> None:
    text = (DATA / "pddl" / "stacks-train1.pddl").read_text()
    problem = tmp_path / "problem.pddl"
    problem.write_text(text.replace("(clear grill)", ""))
    ran = cli("plan-pddl", DATA / "pddl" / "more-stacks-burger-domain.pddl", problem, "--json")
    assert ran.code == 1 and ran.json["status"] == "unsolvable"


def test_inequalities_of_one_action_bind_that_action_only(cli: Cli, tmp_path: Path) -> None:
    """``swap`` excludes equal parameters, ``join`` does not: its one object may fill both."""
    (tmp_path / "domain.pddl").write_text(
        "(define (domain d) (:predicates (p ?a) (q ?a) (r))"
        " (:action swap :parameters (?a ?b) :precondition (and (p ?a) (p ?b) (not (= ?a ?b))) :effect (r))"
        " (:action join :parameters (?a ?b) :precondition (and (p ?a) (p ?b)) :effect (q ?a)))"
    )

    def status(objects: str, goal: str) -> str:
        init = " ".join(f"(p {o})" for o in objects.split())
        text = f"(define (problem x) (:domain d) (:objects {objects}) (:init {init}) (:goal {goal}))"
        (tmp_path / "problem.pddl").write_text(text)
        return str(cli("plan-pddl", tmp_path / "domain.pddl", tmp_path / "problem.pddl", "--json").json["status"])

    assert status("a", "(r)") == "unsolvable"
    assert status("a b", "(r)") == "solved"
    assert status("a", "(q a)") == "solved"


@pytest.mark.parametrize("goal", ["(:goal)", "(:goal (not))", "(:goal (p a) (p a))"])
def test_broken_goals_are_named_with_their_line(cli: Cli, tmp_path: Path, goal: str) -> None:
    (tmp_path / "d.pddl").write_text("(define (domain d) (:predicates (p ?a)))")
    (tmp_path / "p.pddl").write_text(f"(define (problem x) (:domain d)\n(:objects a) (:init (p a))\n{goal})")
    ran = cli("plan-pddl", tmp_path / "d.pddl", tmp_path / "p.pddl")
    assert ran.code == 2 and "line 3" in ran.err and "Traceback" not in ran.err


def test_results_of_a_run_are_not_overwritten(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "config.yaml").write_text("a: run")
    for out in (tmp_path / "selection.json", tmp_path / "elsewhere" / "timings.json"):
        ran = cli("select", WORKLOAD, "--out", out)
        assert ran.code == 2 and "timings.json" in ran.err
