"""Exports with any names are read back by us, and by the parsers of pyperplan and unified-planning."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from extras import need
from pix2pred.planning import AStar, Planner
from pix2pred.planning.pddl.read import read_domain, read_problem
from pix2pred.planning.pddl.steps import read_plan
from pix2pred.planning.pddl.write import write_domain, write_plan, write_problem
from pix2pred.structs import (
    Atom,
    FromDomain,
    LiftedAtom,
    Object,
    Operator,
    Predicate,
    Skill,
    Type,
    Variable,
    Vocabulary,
    WorldModel,
)

NASTY = ("and", "not", "or", "forall", "exists", "when", "imply", "increase", "assign", "either", "object", "number",
         "Über Küche", "On", "on", "ON", "is on", "is_on", "7up", "domain", "define", "total-cost", "-", "Ä", "robot",
         "?x", "a;b", "(x)")  # fmt: skip


def random_model(seed: int) -> tuple[WorldModel, tuple[Object, ...], frozenset[Atom], tuple[Atom, ...]]:
    """A model whose types never overlap, with a task of one step; every name is taken from ``NASTY``."""
    rng = random.Random(seed)

    def names(count: int) -> list[str]:
        return rng.sample([n for n in NASTY if n != "object"], count)

    types = tuple(Type(n, parent=Type("object")) for n in names(2))
    predicates = tuple(Predicate(n, (rng.choice(types),), FromDomain()) for n in names(4))
    skills = tuple(Skill(n, types) for n in ("Put", "Turn"))
    variables = tuple(Variable(f"?x{i}", t) for i, t in enumerate(types))

    def lifted(p: Predicate) -> LiftedAtom:
        return LiftedAtom(p, (variables[types.index(p.types[0])],))

    operators = tuple(
        Operator(f"op{i}", variables, frozenset({lifted(predicates[0])}), frozenset({lifted(predicates[1 + i])}),
                 frozenset({lifted(predicates[0])}), rng.choice(skills), variables)
        for i in range(3)
    )  # fmt: skip
    vocabulary = Vocabulary(rng.choice(NASTY), types, skills, ())
    objects = tuple(Object(n, t) for n, t in zip(names(2), types, strict=True))

    def atom(p: Predicate) -> Atom:
        return p(objects[types.index(p.types[0])])

    model = WorldModel(vocabulary, predicates, operators, "oracle")
    return model, objects, frozenset({atom(predicates[0])}), (atom(predicates[1]),)


@given(st.integers(0, 2**32))
@settings(max_examples=60, deadline=None)
def test_exports_are_read_back(seed: int) -> None:
    model, objects, initial, goal = random_model(seed)
    domain = read_domain(write_domain(model))
    problem = read_problem(write_problem(model, "any", objects, initial, goal), domain)
    assert domain.name == model.vocabulary.name
    assert set(domain.predicates) == set(model.predicates)
    assert {str(a) for a in problem.initial} == {str(a) for a in initial}
    assert {o.name: o.type.name for o in problem.objects} == {o.name: o.type.name for o in objects}
    plan = Planner(AStar()).plan(model.operators, objects, initial, goal).plan
    steps = read_plan(write_plan(model, objects, plan), domain, problem)
    assert [s.objects for s in steps] == [tuple(o.name for o in s.objects) for s in plan]
    assert [s.skill for s in map({o.name: o for o in domain.operators}.__getitem__, [s.action for s in steps])] == [
        s.operator.skill for s in plan
    ]


def test_actions_and_parameters_are_called_after_what_they_do() -> None:
    robot, patty, grill = Type("robot"), Type("patty"), Type("grill")
    holding, on, free = (
        Predicate(n, t, FromDomain()) for n, t in (("Holding", (patty,)), ("On", (patty, grill)), ("Free", (robot,)))
    )
    r, p, g, q = (Variable(n, t) for n, t in (("?x0", robot), ("?x1", patty), ("?x2", grill), ("?x3", patty)))
    held, lies, hand = LiftedAtom(holding, (p,)), LiftedAtom(on, (p, g)), LiftedAtom(free, (r,))
    pick = Skill("Pick", (robot, patty))
    put = Skill("Put", (robot, patty, grill))
    model = WorldModel(
        Vocabulary("Kitchen", (robot, patty, grill), (pick, put), ()),
        (holding, on, free),
        (
            Operator("op0", (r, p), frozenset({hand}), frozenset({held}), frozenset({hand}), pick, (r, p)),
            Operator("op1", (r, p, g), frozenset({held}), frozenset({lies}), frozenset({held}), put, (r, p, g)),
            Operator("op2", (r, p, g, q), frozenset({held}), frozenset({hand}), frozenset({held}), put, (r, q, g)),
        ),
        "oracle",
    )
    text = write_domain(model)
    assert "(:action pick-patty\n  :parameters (?robot - robot ?patty - patty)" in text
    assert "(:action put-patty-grill-on\n" in text and "(:action put-patty-grill-free\n" in text
    assert "?patty-2 - patty" in text
    assert "(:action put-patty-grill-free\n  :parameters (?robot - robot ?patty - patty ?grill - grill ?patty-2" in text


def test_an_effect_that_is_called_like_a_number_gives_no_action_the_name_of_another() -> None:
    thing = Type("thing")
    x = Variable("?x0", thing)
    act = Skill("Act", (thing,))
    on, second = (LiftedAtom(Predicate(n, (thing,), FromDomain()), (x,)) for n in ("on", "v2"))
    added = (frozenset({on, second}), frozenset({on}), frozenset({on}))
    operators = tuple(Operator(f"op{i}", (x,), frozenset(), add, frozenset(), act, (x,)) for i, add in enumerate(added))
    model = WorldModel(Vocabulary("d", (thing,), (act,), ()), (on.predicate, second.predicate), operators, "oracle")
    assert [op.name for op in read_domain(write_domain(model)).operators] == [
        "act-v2",
        "act",
        "act-v3",
    ]


@need("unified_planning", extra="planners")
def test_unified_planning_reads_exports() -> None:
    from unified_planning.io import PDDLReader

    for seed in range(12):
        model, objects, initial, goal = random_model(seed)
        texts = write_domain(model), write_problem(model, "any", objects, initial, goal)
        read = PDDLReader().parse_problem_string(*texts)
        assert len(read.actions) == 3 and len(read.all_objects) == 2 and len(read.fluents) == 4, texts


@need("pyperplan", extra="planners")
def test_pyperplan_reads_exports(tmp_path: Path) -> None:
    from pyperplan.pddl.parser import Parser

    for seed in range(12):
        model, objects, initial, goal = random_model(seed)
        (tmp_path / "d.pddl").write_text(write_domain(model))
        (tmp_path / "p.pddl").write_text(write_problem(model, "any", objects, initial, goal))
        parser = Parser(str(tmp_path / "d.pddl"), str(tmp_path / "p.pddl"))
        problem = parser.parse_problem(parser.parse_domain())
        assert len(problem.domain.actions) == 3 and len(problem.objects) == 2 and len(problem.initial_state) == 1


@pytest.mark.parametrize("word", ["and", "not", "or", "forall", "exists", "when", "imply", "increase", "assign"])
def test_a_predicate_called_like_a_word_of_the_language_is_renamed_and_read_back(word: str) -> None:
    thing = Type("thing", parent=Type("object"))
    named = Predicate(word, (thing,), FromDomain())
    x = Variable("?x0", thing)
    act = Skill("Act", (thing,))
    does = Operator("op0", (x,), frozenset(), frozenset({LiftedAtom(named, (x,))}), frozenset(), act, (x,))
    model = WorldModel(Vocabulary("words", (thing,), (act,), ()), (named,), (does,), "oracle")
    text = write_domain(model)
    assert f";@ name predicate {word}-2 {word}\n" in text and f"({word}-2 ?thing)" in text
    assert read_domain(text).predicates == (named,)
