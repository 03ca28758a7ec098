"""Values that need no query, by source."""

from __future__ import annotations

import pytest

from pix2pred.predicates.initial import is_asked, local_values
from pix2pred.structs import (
    Action,
    FromFeatures,
    FromHuman,
    FromSkills,
    Object,
    Predicate,
    Skill,
    SkillTrigger,
    State,
    Type,
)
from pix2pred.structs.expressions import ExpressionError
from predicates.scripted import BLUE_CUP, COOKED, CUP, HOLDING, ITEM, P1, P2, PICK, ROBOT, R

PICK_P1, PICK_P2 = Action(PICK, (R, P1)), Action(PICK, (R, P2))
SET, CLEARED = (SkillTrigger("Pick", (0, 1)),), (SkillTrigger("Drop", (0, 1)),)


def drop(thing: Object) -> Action:
    return Action(Skill("Drop", (ROBOT, ITEM)), (R, thing))


def held(*, initially: bool = False, set_by: tuple[SkillTrigger, ...] = SET) -> Predicate:
    return Predicate("Held", (ROBOT, ITEM), FromSkills(set_by, CLEARED, initially))


def test_only_visual_atoms_are_asked() -> None:
    assert is_asked(COOKED(P1))
    assert not is_asked(HOLDING(R, P1))
    with pytest.raises(AssertionError, match="labelled by a model"):
        local_values(COOKED(P1), [State()], [])


@pytest.mark.parametrize("predicate", [HOLDING, Predicate("Listed", (ROBOT, ITEM), FromHuman())])
def test_domain_and_human_values_are_those_given_per_state(predicate: Predicate) -> None:
    atom = predicate(R, P1)
    states = [State(), State(given=frozenset({atom})), State(given=frozenset({predicate(R, P2)}))]
    assert local_values(atom, states, [PICK_P1, PICK_P1]) == [0, 1, 0]


def test_skills_set_and_clear() -> None:
    actions = [PICK_P2, PICK_P1, PICK_P2, drop(P2), drop(P1), drop(P1)]
    states = [State()] * 7
    assert local_values(held()(R, P1), states, actions) == [0, 0, 1, 1, 1, 0, 0]
    assert local_values(held()(R, P2), states, actions) == [0, 1, 1, 1, 0, 0, 0]
    assert local_values(held()(R, BLUE_CUP), states, actions) == [0] * 7


def test_first_values_are_declared_or_given() -> None:
    atom = held()(R, P1)
    assert local_values(atom, [State()], []) == [0]
    assert local_values(atom, [State(given=frozenset({atom}))], []) == [1]
    assert local_values(held(initially=True)(R, P1), [State()] * 2, [drop(P1)]) == [1, 0]


def test_arguments_are_bound_by_position() -> None:
    turned = Predicate("HeldBy", (ITEM, ROBOT), FromSkills((SkillTrigger("Pick", (1, 0)),)))
    assert local_values(turned(P1, R), [State()] * 2, [PICK_P1]) == [0, 1]
    nothing = Predicate("Busy", (), FromSkills((SkillTrigger("Pick", ()),), (SkillTrigger("Drop", ()),)))
    assert local_values(nothing(), [State()] * 3, [PICK_P1, drop(P2)]) == [0, 1, 0]


def test_setting_wins_over_clearing() -> None:
    both = held(set_by=(SkillTrigger("Pick", (0, 1)), *CLEARED))
    assert local_values(both(R, P1), [State()] * 2, [drop(P1)]) == [0, 1]


def test_features() -> None:
    mug = Type("mug", ("z",), CUP)
    m = Object("m", mug)
    low = Predicate("Low", (mug,), FromFeatures("(<= mug.z 1)"))
    states = [State((), {m: (z,)}) for z in (0.5, 1.0, 1.5)]
    assert local_values(low(m), states, [PICK_P1] * 2) == [1, 1, 0]
    with pytest.raises(ExpressionError, match="m has no feature 'z'"):
        local_values(low(m), [State()], [])
