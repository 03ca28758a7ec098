"""Shapes of PDDL that people bring: each is read, and means what the plain form of the same domain means."""

from __future__ import annotations

from pathlib import Path

import pytest

from pix2pred.cli.app import run
from pix2pred.planning import AStar, Planner
from pix2pred.planning.pddl.check import check_plan
from pix2pred.planning.pddl.plans import solve_pddl
from pix2pred.planning.pddl.read import read_domain, read_problem
from pix2pred.structs import PlanStatus

VANS = """(define (domain vans) (:requirements :strips :typing)
 (:types thing place - object van box - thing)
 (:constants depot - place)
 (:predicates (at ?x - thing ?p - place) (in ?x - thing ?y - thing))
 (:functions (total-cost) - number (dist ?a - place ?b - place) - number)
 (:action drive :parameters (?v - van ?a - place ?b - place)
  :precondition (at ?v ?a) :effect (and (at ?v ?b) (not (at ?v ?a))))
 (:action load :parameters (?b - box ?v - van ?p - place)
  :precondition (and (at ?v ?p) (at ?b ?p)) :effect (and (in ?b ?v) (not (at ?b ?p))))
 (:action unload :parameters (?b - box ?v - van ?p - place)
  :precondition (and (at ?v ?p) (in ?b ?v)) :effect (and (at ?b ?p) (not (in ?b ?v)))))
"""
TRIP = """(define (problem trip) (:domain vans)
 (:objects van1 - van box1 - box north south - place)
 (:init (at van1 north) (at box1 south))
 (:goal (and (at box1 north))))
"""


def length(domain_text: str, problem_text: str) -> int | None:
    """Length of a shortest plan, checked."""
    domain = read_domain(domain_text)
    problem = read_problem(problem_text, domain)
    found = solve_pddl(domain, problem, Planner(AStar()))
    if found.status != PlanStatus.SOLVED:
        return None
    assert check_plan(domain, problem, found.steps).valid
    return len(found.steps)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("(:types thing place - object van box - thing)", "(:types van box - thing place)"),
        ("van box - thing)", "van box - thing area - object area - place)"),
        ("(:requirements :strips :typing)", ""),
        (":strips :typing", ":adl :fluents :something-new"),
        ("?y - thing))", "?x - thing))"),
        (":precondition (at ?v ?a)", ":precondition (at?v ?a)"),
        ("(at ?x - thing", "(at ?x - (either van box)"),
        (":precondition (at ?v ?a)", ":precondition (and (at ?v ?a) (not (at ?v ?b)))"),
        (":precondition (at ?v ?a)", ":precondition (and (at ?v ?a) (not (= ?a ?b)))"),
        (":precondition (at ?v ?a)", ":precondition (exists (?x - box) (and (at ?v ?a) (not (in ?v ?x))))"),
        (":precondition (at ?v ?a)", ":precondition (forall (?x - place) (imply (not (= ?x ?a)) (not (at ?v ?x))))"),
        (":precondition (at ?v ?a)", ":precondition (and (at ?v ?a) (or (at ?v ?a) (at ?v depot)))"),
        ("(not (at ?v ?a))", "(forall (?x - place) (when (and (at ?v ?x) (not (= ?x ?b))) (not (at ?v ?x))))"),
        ("(not (at ?v ?a))", "(not (at ?v depot)) (not (at ?v ?a))"),
        (":effect (and (at ?v ?b)", ":effect (and (increase (total-cost) 3) (at ?v ?b)"),
        ("(:action drive", "(:derived (in ?x - thing ?y - thing) (at ?x depot)) (:action drive"),
    ],
)
def test_a_shape_means_what_the_plain_form_means(old: str, new: str) -> None:
    assert old in VANS
    domain = VANS.replace(old, new, 1)
    if ":derived" in new:  # what is derived cannot be changed: the van only drives then
        domain = domain[: domain.index(" (:action load")] + ")"
        assert length(domain, TRIP.replace("(at box1 north)", "(in van1 van1)")) == 1
        return
    assert length(VANS, TRIP) == 4
    assert length(domain, TRIP) == 4


@pytest.mark.parametrize(
    ("goal", "wanted"),
    [
        ("(not (at box1 south))", 2),
        ("(or (at box1 north) (at van1 south))", 1),
        ("(imply (at van1 north) (at van1 depot))", 1),
        ("(and (not (at van1 north)) (not (at van1 south)))", 1),
        ("(forall (?x - thing) (not (at ?x south)))", 2 + 1),
        ("(exists (?x - box) (in ?x van1))", 2),
        ("(and (at van1 north) (not (at van1 north)))", None),
        ("(or)", None),
        ("(and)", 0),
        ("()", 0),
    ],
)
def test_goals(goal: str, wanted: int | None) -> None:
    assert length(VANS, TRIP.replace("(and (at box1 north))", goal)) == wanted


COSTS = VANS.replace(":effect (and (at ?v ?b)", ":effect (and (increase (total-cost) (dist ?a ?b)) (at ?v ?b)", 1)
ROADS = " ".join(
    f"(= (dist {a} {b}) {d})"
    for a, b, d in [
        ("north", "south", 90), ("south", "north", 90), ("north", "depot", 1),
        ("depot", "north", 1), ("depot", "south", 2), ("south", "depot", 2),
    ]
)  # fmt: skip


@pytest.mark.parametrize("planner", ["astar-lmcut", "gbfs-ff", "portfolio"])
def test_costs_are_minimised_when_that_is_asked(
    planner: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    metric = "(:metric minimize (total-cost)) (:goal"
    (tmp_path / "d.pddl").write_text(COSTS)
    asked = TRIP.replace("(at box1 south)", f"(at box1 south) (= (total-cost) 0) {ROADS}").replace("(:goal", metric)
    for name, text in (("asked", asked), ("not", asked.replace("(:metric minimize (total-cost))", ""))):
        (tmp_path / f"{name}.pddl").write_text(text)
    files = (str(tmp_path / "d.pddl"), str(tmp_path / "asked.pddl"))
    assert run(["plan-pddl", *files, "--planner", planner]) == 0
    assert "6 steps, cost 6, " in capsys.readouterr().out
    assert run(["plan-pddl", files[0], str(tmp_path / "not.pddl"), "--planner", planner]) == 0
    assert "4 steps, cost 180 (no :metric asks for a small one), " in capsys.readouterr().out


def test_comments_may_be_in_any_encoding_and_names_may_not(tmp_path: Path) -> None:
    (tmp_path / "d.pddl").write_bytes(b"; Autor: Jos\xe9\n" + VANS.encode())
    (tmp_path / "p.pddl").write_text(TRIP)
    assert run(["plan-pddl", str(tmp_path / "d.pddl"), str(tmp_path / "p.pddl")]) == 0
    (tmp_path / "d.pddl").write_bytes(VANS.replace("depot", "d\xe9pot").encode("latin-1"))
    assert run(["plan-pddl", str(tmp_path / "d.pddl"), str(tmp_path / "p.pddl")]) == 2


PLAN = "(drive van1 north south)\n(load box1 van1 south)\n(drive van1 south north)\n(unload box1 van1 north)\n"


@pytest.mark.parametrize(
    ("plan", "code", "said"),
    [
        (PLAN, 0, "; valid, 4 steps, cost 4"),
        (PLAN.upper() + "; cost = 4\n", 0, "; valid, 4 steps, cost 4"),
        (PLAN.replace("(load", "0.1: (load").replace("1 south)\n(dr", "1 south) [1.0]\n(dr"), 0, "; valid, 4 steps"),
        (
            PLAN.replace("(load box1 van1 south)\n", ""),
            1,
            "3 (unload box1 van1 north)\n    cannot be executed: (in box1",
        ),
        (PLAN.replace("(unload box1 van1 north)\n", ""), 1, "the goal is not reached: (at box1 north) does not hold"),
        ("(fly van1)\n", 1, "1 (fly van1)\n    cannot be executed: there is no action fly"),
        ("(drive van1 north)\n", 1, "drive takes 3 objects, found 2"),
        ("(drive box1 north south)\n", 1, "box1 is no van"),
        ("(drive van2 north south)\n", 1, "there is no object van2"),
        ("", 1, "; invalid, 0 steps, cost 0"),
    ],
)
def test_a_plan_is_validated_step_by_step(
    plan: str, code: int, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, text in (("d.pddl", VANS), ("p.pddl", TRIP), ("plan.txt", plan)):
        (tmp_path / name).write_text(text)
    files = [str(tmp_path / name) for name in ("d.pddl", "p.pddl", "plan.txt")]
    assert run(["validate", *files]) == code
    assert said in capsys.readouterr().out
    assert run(["validate", *files, "--explain", "--json"]) == code


def test_an_explanation_says_what_every_step_changes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, text in (("d.pddl", VANS), ("p.pddl", TRIP), ("plan.txt", PLAN)):
        (tmp_path / name).write_text(text)
    assert run(["validate", *(str(tmp_path / n) for n in ("d.pddl", "p.pddl", "plan.txt")), "--explain"]) == 0
    assert "2 (load box1 van1 south)\n    + (in box1 van1)\n    - (at box1 south)\n" in capsys.readouterr().out


def test_a_file_that_is_no_plan_is_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, text in (("d.pddl", VANS), ("p.pddl", TRIP), ("plan.txt", "drive north\n")):
        (tmp_path / name).write_text(text)
    assert run(["validate", *(str(tmp_path / n) for n in ("d.pddl", "p.pddl", "plan.txt"))]) == 2
    assert "plan.txt: line 1, column 1: expected one (action object ...) a line" in capsys.readouterr().err
