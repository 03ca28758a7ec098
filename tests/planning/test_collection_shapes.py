"""Kinds of domains as in public collections: each is read, solved, and its plan accepted by code of its own."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from pix2pred.planners import Planners
from pix2pred.planning import AStar, Planner
from pix2pred.planning.pddl.check import check_plan
from pix2pred.planning.pddl.plans import solve_pddl
from pix2pred.planning.pddl.read import read_domain, read_problem
from pix2pred.planning.pddl.syntax import PddlError
from pix2pred.structs import PlanStatus


@dataclass(frozen=True)
class Shape:
    """Sections of a domain behind its name, and of a problem; ``steps`` is the length of a shortest plan."""

    domain: str
    problem: str
    steps: int

    def texts(self) -> tuple[str, str]:
        return f"(define (domain d)\n{self.domain})", f"(define (problem p) (:domain d)\n{self.problem})"


SHAPES = {
    "two arms, types as predicates": Shape(
        """(:predicates (room ?r) (ball ?b) (arm ?g) (here ?r) (at ?b ?r) (free ?g) (carry ?b ?g))
        (:action move :parameters (?a ?b) :precondition (and (room ?a) (room ?b) (here ?a))
          :effect (and (here ?b) (not (here ?a))))
        (:action pick :parameters (?b ?r ?g)
          :precondition (and (ball ?b) (room ?r) (arm ?g) (at ?b ?r) (here ?r) (free ?g))
          :effect (and (carry ?b ?g) (not (at ?b ?r)) (not (free ?g))))
        (:action drop :parameters (?b ?r ?g) :precondition (and (carry ?b ?g) (here ?r))
          :effect (and (at ?b ?r) (free ?g) (not (carry ?b ?g))))""",
        """(:objects r1 r2 b1 b2 l r) (:init (room r1) (room r2) (ball b1) (ball b2) (arm l) (arm r) (here r1)
        (free l) (free r) (at b1 r1) (at b2 r1)) (:goal (and (at b1 r2) (at b2 r2)))""",
        5,
    ),
    "a propositional domain, actions without parameters": Shape(
        """(:predicates (a) (b) (c)) (:action one :precondition (a) :effect (and (b) (not (a))))
        (:action two :parameters () :precondition (and (b)) :effect (c))""",
        "(:init (a)) (:goal (c))",
        2,
    ),
    "a domain file for one problem, objects as constants": Shape(
        """(:types order product) (:constants o1 o2 - order p1 p2 - product)
        (:predicates (made ?p - product) (shipped ?o - order))
        (:action make-p1 :parameters () :precondition (not (made p1)) :effect (made p1))
        (:action make-p2 :parameters () :precondition (not (made p2)) :effect (made p2))
        (:action ship-o1 :parameters () :precondition (made p1) :effect (shipped o1))
        (:action ship-o2 :parameters () :precondition (and (made p1) (made p2)) :effect (shipped o2))""",
        "(:init) (:goal (and (shipped o1) (shipped o2)))",
        4,
    ),
    "counters as successors of numbers": Shape(
        """(:types num) (:predicates (next ?a ?b - num) (fuel ?n - num) (at ?n - num))
        (:action go :parameters (?a ?b ?f ?g - num) :precondition (and (at ?a) (next ?a ?b) (fuel ?f) (next ?g ?f))
          :effect (and (at ?b) (not (at ?a)) (fuel ?g) (not (fuel ?f))))""",
        """(:objects n0 n1 n2 n3 - num) (:init (next n0 n1) (next n1 n2) (next n2 n3) (fuel n3) (at n0))
        (:goal (at n3))""",
        3,
    ),
    "places that are closed behind one": Shape(
        """(:types cell) (:predicates (by ?a ?b - cell) (at ?a - cell) (seen ?a - cell))
        (:action go :parameters (?a ?b - cell) :precondition (and (at ?a) (by ?a ?b) (not (seen ?b)))
          :effect (and (at ?b) (not (at ?a)) (seen ?b)))""",
        """(:objects a b c d - cell) (:init (at a) (seen a) (by a b) (by b a) (by b c) (by a d) (by d c) (by c d))
        (:goal (and (seen b) (seen c) (seen d)))""",
        3,
    ),
    "pushing": Shape(
        """(:types cell way) (:predicates (by ?a ?b - cell ?w - way) (man ?a - cell) (box ?a - cell) (free ?a - cell))
        (:action walk :parameters (?a ?b - cell ?w - way) :precondition (and (man ?a) (by ?a ?b ?w) (free ?b))
          :effect (and (man ?b) (free ?a) (not (man ?a)) (not (free ?b))))
        (:action push :parameters (?a ?b ?c - cell ?w - way)
          :precondition (and (man ?a) (box ?b) (free ?c) (by ?a ?b ?w) (by ?b ?c ?w))
          :effect (and (man ?b) (box ?c) (free ?a) (not (man ?a)) (not (box ?b)) (not (free ?c))))""",
        """(:objects a b c d - cell e w - way) (:init (by a b e) (by b c e) (by c d e) (by b a w) (by c b w) (by d c w)
        (man a) (box b) (free c) (free d)) (:goal (box d))""",
        2,
    ),
    "lifts with costs by floor": Shape(
        """(:requirements :action-costs) (:types floor man) (:predicates (lift ?f - floor) (at ?m - man ?f - floor)
        (in ?m - man)) (:functions (total-cost) (ride ?a ?b - floor) - number)
        (:action ride :parameters (?a ?b - floor) :precondition (lift ?a)
          :effect (and (lift ?b) (not (lift ?a)) (increase (total-cost) (ride ?a ?b))))
        (:action board :parameters (?m - man ?f - floor) :precondition (and (lift ?f) (at ?m ?f))
          :effect (and (in ?m) (not (at ?m ?f))))
        (:action leave :parameters (?m - man ?f - floor) :precondition (and (lift ?f) (in ?m))
          :effect (and (at ?m ?f) (not (in ?m))))""",
        """(:objects f0 f1 f2 - floor m - man) (:init (= (total-cost) 0) (lift f0) (at m f0)
        (= (ride f0 f1) 2) (= (ride f1 f2) 2) (= (ride f0 f2) 5)) (:goal (at m f2)) (:metric minimize (total-cost))""",
        4,
    ),
    "actions that cost nothing": Shape(
        """(:predicates (a) (b) (c)) (:functions (total-cost))
        (:action free :precondition (a) :effect (and (b) (increase (total-cost) 0)))
        (:action dear :precondition (a) :effect (and (c) (increase (total-cost) 7)))
        (:action cheap :precondition (b) :effect (and (c) (increase (total-cost) 1)))""",
        "(:init (a)) (:goal (c)) (:metric minimize (total-cost))",
        2,
    ),
    "switches of circuits, derived and recursive": Shape(
        """(:types node) (:predicates (wire ?a ?b - node) (closed ?a - node) (source ?a - node) (fed ?a - node))
        (:derived (fed ?b - node) (or (source ?b) (exists (?a - node) (and (wire ?a ?b) (closed ?a) (fed ?a)))))
        (:action close :parameters (?a - node) :precondition (not (closed ?a)) :effect (closed ?a))""",
        "(:objects a b c - node) (:init (source a) (wire a b) (wire b c)) (:goal (fed c))",
        2,
    ),
    "derived and negated": Shape(
        """(:types cell) (:predicates (by ?a ?b - cell) (full ?a - cell) (blocked ?a - cell) (at ?a - cell))
        (:derived (blocked ?a - cell) (full ?a))
        (:derived (blocked ?a - cell) (exists (?b - cell) (and (by ?a ?b) (full ?b))))
        (:action clear :parameters (?a - cell) :precondition (full ?a) :effect (not (full ?a)))
        (:action go :parameters (?a ?b - cell) :precondition (and (at ?a) (not (blocked ?b)))
          :effect (and (at ?b) (not (at ?a))))""",
        "(:objects a b c - cell) (:init (at a) (by b c) (full c)) (:goal (at b))",
        2,
    ),
    "passengers who leave when the lift stops, with effects over all": Shape(
        """(:types floor man) (:predicates (from ?m - man ?f - floor) (to ?m - man ?f - floor) (in ?m - man)
        (served ?m - man) (lift ?f - floor)) (:action stop :parameters (?f - floor) :precondition (lift ?f)
          :effect (and (forall (?m - man) (when (and (in ?m) (to ?m ?f)) (and (not (in ?m)) (served ?m))))
                       (forall (?m - man) (when (and (from ?m ?f) (not (served ?m))) (in ?m)))))
        (:action ride :parameters (?a ?b - floor) :precondition (and (lift ?a) (not (= ?a ?b)))
          :effect (and (lift ?b) (not (lift ?a))))""",
        """(:objects f g - floor m n - man) (:init (lift f) (from m f) (to m g) (from n g) (to n f))
        (:goal (forall (?m - man) (served ?m)))""",
        5,
    ),
    "sorting with effects under conditions": Shape(
        """(:types box) (:predicates (small ?b - box) (left ?b - box) (right ?b - box) (on))
        (:action press :effect (and (when (on) (not (on))) (when (not (on)) (on))))
        (:action sort :parameters (?b - box) :effect (and (when (on) (left ?b)) (when (not (on)) (right ?b))))""",
        "(:objects a b - box) (:init) (:goal (and (right a) (left b)))",
        3,
    ),
    "a machine that must be idle, all its parts": Shape(
        """(:types machine part) (:predicates (of ?p - part ?m - machine) (busy ?p - part) (off ?m - machine))
        (:action rest :parameters (?p - part) :precondition (busy ?p) :effect (not (busy ?p)))
        (:action switch :parameters (?m - machine) :precondition (forall (?p - part) (imply (of ?p ?m) (not (busy ?p))))
          :effect (off ?m))""",
        "(:objects m - machine p q - part) (:init (of p m) (of q m) (busy p) (busy q)) (:goal (off m))",
        3,
    ),
    "doors with either of two keys": Shape(
        """(:types key card - thing place) (:predicates (have ?x - (either key card))
        (opens ?x - (either key card) ?p - place)
        (open ?p - place))
        (:action get :parameters (?x - (either key card)) :effect (have ?x))
        (:action unlock :parameters (?x - (either key card) ?p - place) :precondition (and (have ?x) (opens ?x ?p))
          :effect (open ?p))""".replace(
            "(:types thing place) (:types key card - thing)", "(:types key card - thing place)"
        ),
        "(:objects k - key c - card p - place) (:init (opens c p)) (:goal (open p))",
        2,
    ),
    "two names for one place": Shape(
        """(:predicates (at ?x) (road ?a ?b)) (:action go :parameters (?a ?b)
          :precondition (and (at ?a) (road ?a ?b) (not (= ?a ?b))) :effect (and (at ?b) (not (at ?a))))""",
        "(:objects a b) (:init (at a) (road a a) (road a b)) (:goal (at b))",
        1,
    ),
    "an action whose effects meet": Shape(
        """(:predicates (at ?x)) (:action go :parameters (?a ?b) :precondition (at ?a)
          :effect (and (not (at ?a)) (at ?b)))""",
        "(:objects a b) (:init (at a)) (:goal (and (at b) (not (at a))))",
        1,
    ),
    "names that are words, and cases mixed": Shape(
        """(:Predicates (Object-At ?Thing) (and-more) (not-yet)) (:ACTION When :parameters (?Exists)
          :Precondition (OBJECT-AT ?exists) :Effect (and (And-More) (not (not-yet))))""",
        "(:objects Forall_1) (:init (object-at FORALL_1) (not-yet)) (:goal (and (AND-MORE) (not (not-yet))))",
        1,
    ),
    "types that name types of names": Shape(
        """(:types vehicle - object truck plane - vehicle city location - object airport - location)
        (:predicates (in ?l - location ?c - city) (at ?v - vehicle ?l - location))
        (:action drive :parameters (?t - truck ?a ?b - location ?c - city)
          :precondition (and (at ?t ?a) (in ?a ?c) (in ?b ?c)) :effect (and (at ?t ?b) (not (at ?t ?a))))
        (:action fly :parameters (?p - plane ?a ?b - airport) :precondition (at ?p ?a)
          :effect (and (at ?p ?b) (not (at ?p ?a))))""",
        """(:objects t - truck p - plane c d - city l - location a b - airport)
        (:init (in l c) (in a c) (in b d) (at t l) (at p a)) (:goal (and (at t a) (at p b)))""",
        2,
    ),
    "windows of time as facts": Shape(
        """(:types time) (:predicates (now ?t - time) (then ?a ?b - time) (open ?t - time) (done))
        (:action wait :parameters (?a ?b - time) :precondition (and (now ?a) (then ?a ?b))
          :effect (and (now ?b) (not (now ?a))))
        (:action work :parameters (?t - time) :precondition (and (now ?t) (open ?t)) :effect (done))""",
        "(:objects t0 t1 t2 - time) (:init (now t0) (then t0 t1) (then t1 t2) (open t2)) (:goal (done))",
        3,
    ),
    "a goal that holds, and an action that nothing needs": Shape(
        "(:predicates (a) (b)) (:action x :effect (b))", "(:init (a)) (:goal (and (a) (not (b))))", 0
    ),
}


@pytest.mark.parametrize("name", SHAPES)
def test_a_kind_of_domain_is_solved_and_its_plan_is_accepted(name: str) -> None:
    domain_text, problem_text = SHAPES[name].texts()
    domain = read_domain(domain_text)
    problem = read_problem(problem_text, domain)
    quick = Planners().planner("quick", distinct=domain.distinct)
    assert isinstance(quick, Planner)
    for planner in (Planner(AStar()), quick):
        found = solve_pddl(domain, problem, planner)
        checked = check_plan(domain, problem, found.steps)
        assert found.status == PlanStatus.SOLVED and checked.valid
        assert len(found.steps) >= SHAPES[name].steps
    assert len(solve_pddl(domain, problem, Planner(AStar())).steps) == SHAPES[name].steps


PLAIN = """(define (domain d)
 (:types ball)
 (:predicates (a ?b - ball))
 (:action go
  :parameters (?b - ball)
  :precondition (a ?b)
  :effect (not (a ?b))))"""


@pytest.mark.parametrize(
    ("old", "new", "place", "said"),
    [
        (":precondition (a ?b)", ":precondition (> (fuel) 1)", "line 6, column 17", "numeric conditions"),
        (":effect (not (a ?b))", ":effect (decrease (fuel) 1)", "line 7, column 11", "numeric effects"),
        (":effect (not (a ?b))", ":effect (oneof (a ?b) (not (a ?b)))", "line 7, column 11", "effects of chance"),
        (":effect (not (a ?b))", ":effect (probabilistic 1/2 (a ?b))", "line 7, column 11", "effects of chance"),
        (":effect (not (a ?b))", ":effect (or (a ?b))", "line 7, column 11", "without a definite outcome"),
        (":precondition (a ?b)", ":precondition (preference p (a ?b))", "line 6, column 17", "preferences"),
        (":precondition (a ?b)", ":precondition (always (a ?b))", "line 6, column 17", "constraints on trajectories"),
        (":precondition (a ?b)", ":precondition (a ?c)", "line 6, column 20", "?c is no variable here"),
        (":precondition (a ?b)", ":precondition (b ?b)", "line 6, column 18", "predicate b is not declared"),
        (":precondition (a ?b)", ":precondition (a ?b ?b)", "line 6, column 17", "takes 1 arguments, found 2"),
        ("(:types ball)", "(:types ball - )", "line 2, column 15", "a type is missing after '-'"),
        ("- ball))\n (:action", "- bal))\n (:action", "line 3, column 23", "type bal is not declared"),
        (
            "(:types ball)",
            "(:types ball) (:functions (of ?b) - ball)",
            "line 2, column 36",
            "functions whose values are objects",
        ),
        ("(:action go", "(:durative-action go", "line 4, column 2", "durative"),
        ("(a ?b))))", "(a ?b)))) (x)", "line 7, column 26", "text after the end of the definition"),
        ("(a ?b))))", "(a ?b)))", "line 1, column 1", "this parenthesis is never closed"),
    ],
)
def test_what_is_not_read_is_named_with_its_place(old: str, new: str, place: str, said: str) -> None:
    assert old in PLAIN
    with pytest.raises(PddlError) as caught:
        read_domain(PLAIN.replace(old, new, 1))
    assert str(caught.value).startswith(f"{place}: ") and said in str(caught.value)
