"""Types, objects, atoms, written applications, and the laws of operators."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pix2pred.structs import (
    Action,
    Application,
    FromDomain,
    FromHuman,
    FromVLM,
    LiftedAtom,
    Object,
    Operator,
    Predicate,
    Skill,
    Type,
    Variable,
    groundings,
    parse_application,
)

THING = Type("thing")
ITEM = Type("item", ("x",), THING)
CUP = Type("cup", (), ITEM)
ROBOT = Type("robot", (), THING)
TYPES = (THING, ITEM, CUP, ROBOT)
OBJECTS = (Object("c2", CUP), Object("r", ROBOT), Object("i", ITEM), Object("c10", CUP))
ON = Predicate("On", (ITEM, THING), FromDomain())
HELD = Predicate("Held", (ITEM,), FromDomain())
FREE = Predicate("Free", (), FromDomain())
PICK = Skill("Pick", (ROBOT, ITEM))
R, X, Y = Variable("?r", ROBOT), Variable("?x", ITEM), Variable("?y", THING)


def test_a_type_is_what_its_ancestors_are() -> None:
    assert [t.name for t in TYPES if CUP.is_a(t)] == ["thing", "item", "cup"]
    assert not THING.is_a(ITEM)
    assert not ROBOT.is_a(ITEM)


def test_features_are_not_inherited() -> None:
    assert CUP.features == ()


def test_groundings_are_sorted_and_typed() -> None:
    tuples = [" ".join(o.name for o in t) for t in groundings((ROBOT, ITEM), OBJECTS, distinct=True)]
    assert tuples == ["r c10", "r c2", "r i"]


def test_distinct_leaves_out_repeated_objects() -> None:
    every = list(groundings((CUP, CUP), OBJECTS, distinct=False))
    assert [len(set(t)) for t in every] == [1, 2, 2, 1]
    assert list(groundings((CUP, CUP), OBJECTS, distinct=True)) == every[1:3]


def test_no_arguments_have_one_grounding() -> None:
    assert list(groundings((), OBJECTS, distinct=True)) == [()]


@given(st.permutations(OBJECTS), st.lists(st.sampled_from(TYPES), max_size=3), st.booleans())
def test_groundings_do_not_depend_on_the_order_of_objects(
    objects: list[Object], types: list[Type], distinct: bool
) -> None:
    found = list(groundings(types, objects, distinct=distinct))
    assert found == list(groundings(types, OBJECTS, distinct=distinct))
    assert found == sorted(set(found))
    assert all(o.type.is_a(t) for bound in found for o, t in zip(bound, types, strict=True))


NAMES = st.text(alphabet="abcXYZ019_-?<=.", min_size=1, max_size=8)


@given(NAMES, st.lists(NAMES, max_size=4))
def test_applications_print_and_parse_back(name: str, args: list[str]) -> None:
    written = Application(name, tuple(args))
    assert parse_application(str(written)) == written
    assert parse_application(f"  {name} ( {' ,  '.join(args)} ) ") == written


@pytest.mark.parametrize(
    "text", ["", "On", "On(", "On)", "On(a", "(a)", "On(a,)", "On(,a)", "On(a)(b)", "On(a) b", "a On(b)"]
)
def test_other_texts_are_no_applications(text: str) -> None:
    with pytest.raises(ValueError, match=r"expected|empty"):
        parse_application(text)


@given(st.text())
def test_any_text_gives_an_application_or_a_value_error(text: str) -> None:
    try:
        parse_application(text)
    except ValueError as error:
        assert str(error)


def pick(**changes: frozenset[LiftedAtom]) -> Operator:
    parts = {
        "preconditions": frozenset({LiftedAtom(ON, (X, Y)), LiftedAtom(FREE, ())}),
        "add": frozenset({LiftedAtom(HELD, (X,))}),
        "delete": frozenset({LiftedAtom(ON, (X, Y)), LiftedAtom(FREE, ())}),
    }
    parts |= changes
    return Operator("Pick1", (R, X, Y), parts["preconditions"], parts["add"], parts["delete"], PICK, (R, X))


def test_a_lawful_operator_breaks_no_law() -> None:
    assert list(pick().broken_laws()) == []


@pytest.mark.parametrize(
    ("changes", "law"),
    [
        ({"delete": frozenset[LiftedAtom]()}, "parameters are not exactly"),
        ({"delete": frozenset({LiftedAtom(ON, (X, Y)), LiftedAtom(HELD, (X,))})}, "both added and deleted"),
        ({"add": frozenset({LiftedAtom(FREE, ())}), "delete": frozenset({LiftedAtom(ON, (X, Y))})}, "also a precond"),
        ({"preconditions": frozenset({LiftedAtom(FREE, ())})}, "deleted atom is not a precondition"),
        (
            {"preconditions": pick().preconditions | {LiftedAtom(HELD, (Variable("?z", ITEM),))}},
            "mentions a variable that is no parameter",
        ),
    ],
)
def test_broken_laws_are_named(changes: dict[str, frozenset[LiftedAtom]], law: str) -> None:
    assert any(law in sentence for sentence in pick(**changes).broken_laws())


def test_applying_deletes_first_and_then_adds() -> None:
    c, i, r = OBJECTS[0], OBJECTS[2], OBJECTS[1]
    ground = pick().ground((r, c, i))
    before = frozenset({ON(c, i), FREE(), ON(i, c)})
    assert ground.applicable(before)
    assert ground.apply(before) == {HELD(c), ON(i, c)}
    assert not ground.applicable(ground.apply(before))
    assert ground.skill_objects == (r, c)


def test_grounding_needs_one_object_for_each_parameter() -> None:
    with pytest.raises(ValueError, match="zip"):
        pick().ground(OBJECTS[:2])


def test_parameters_that_are_not_fixed_are_bound_in_every_way() -> None:
    cup, robot, item, other = OBJECTS
    bound = [g.objects for g in pick().groundings({R: robot}, reversed(OBJECTS))]
    assert bound == [(robot, x, y) for x in (other, cup, item) for y in (other, cup, item) if x != y]
    assert [g.objects for g in pick().groundings({R: robot, X: item, Y: cup}, ())] == [(robot, item, cup)]


@pytest.mark.parametrize("fixed", [{R: OBJECTS[0]}, {X: OBJECTS[1]}, {X: OBJECTS[0], Y: OBJECTS[0]}])
def test_what_does_not_fit_is_bound_in_no_way(fixed: dict[Variable, Object]) -> None:
    assert list(pick().groundings(fixed, OBJECTS)) == []


def test_actions_print_plain_numbers() -> None:
    cup, robot = OBJECTS[0], OBJECTS[1]
    params = (np.float64(0.5), float(np.float32(0.25)), 1)
    assert str(Action(PICK, (robot, cup), params)) == "Pick(r, c2)[0.5, 0.25, 1.0]"
    assert str(Action(PICK, (robot, cup))) == "Pick(r, c2)"


def test_where_values_come_from_is_no_part_of_a_predicate() -> None:
    listed, asked = Predicate("On", (ITEM, THING), FromHuman()), Predicate("On", (ITEM, THING), FromVLM("on"))
    assert ON == listed == asked
    assert len({hash(p) for p in (ON, listed, asked)}) == 1
    cup, tray = OBJECTS[0], OBJECTS[2]
    assert ON(cup, tray) in frozenset({asked(cup, tray)})
    assert Predicate("On", (THING, THING), FromDomain()) != ON
    assert Predicate("Under", (ITEM, THING), FromDomain()) != ON


@pytest.mark.parametrize(
    "text",
    ["not In(ice, glass)", "not(In(ice, glass))", "(not (In ice glass))", "!In(a)", "¬In(a)", "NOT In(a, b)"],
)
def test_negated_atoms_are_named_as_such(text: str) -> None:
    with pytest.raises(ValueError, match="is negated, and only goals may say what must not hold"):
        parse_application(text)


@pytest.mark.parametrize("text", ["nothing(a)", "notes(a)", "Not_in(a, b)"])
def test_names_that_begin_like_a_negation_are_names(text: str) -> None:
    assert str(parse_application(text)) == text
