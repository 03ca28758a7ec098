"""The verdict on a model: an operator whose effect the labels deny is named, one whose effect they show is not."""

from __future__ import annotations

import numpy as np
import pytest

from pix2pred.runs.verdict import Climbed, concerns, sentences, spoken
from pix2pred.structs import (
    Action,
    FromFeatures,
    FromVLM,
    Label,
    LabelledDemo,
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

LAMP = Type("lamp")
L1 = Object("l1", LAMP)
LIT, HOT = (Predicate(name, (LAMP,), FromVLM(name)) for name in ("Lit", "Hot"))
PRESS = Skill("Press", (LAMP,))
X = Variable("?x0", LAMP)
CLIMBED = Climbed(candidates=1, at_once=False, first_j=10.0, threshold=None)


def model(*, hot_ends: bool) -> WorldModel:
    lit, hot = LiftedAtom(LIT, (X,)), LiftedAtom(HOT, (X,))
    press = Operator("Op0", (X,), frozenset({hot}), frozenset({lit}), frozenset({hot} if hot_ends else ()), PRESS, (X,))
    return WorldModel(Vocabulary("lamps", (LAMP,), (PRESS,), (LIT,)), (HOT,), (press,), "fake")


def demo(number: int, *, hot_after: bool) -> LabelledDemo:
    """A lamp is pressed; it is lit then, and hot before."""
    rows = [[Label.FALSE, Label.TRUE], [Label.TRUE, Label.of(hot_after)]]
    action = Action(PRESS, (L1,))
    return LabelledDemo(f"d{number}", (L1,), (action,), (LIT(L1),), (LIT(L1), HOT(L1)), np.array(rows, np.int8))


@pytest.mark.parametrize(
    ("hot_ends", "hot_after", "odd"), [(True, True, True), (True, False, False), (False, True, False)]
)
def test_an_effect_that_the_labels_deny_is_named(hot_ends: bool, hot_after: bool, odd: bool) -> None:
    found = concerns(model(hot_ends=hot_ends), [demo(i, hot_after=hot_after) for i in range(2)], CLIMBED)
    said = [c.text for c in found if "at odds" in c.text]
    assert bool(said) is odd
    if odd:
        assert "Hot becomes false is not labelled after 2 of the 2 times" in said[0]


def test_a_minority_of_wrong_labels_is_no_concern() -> None:
    demos = [demo(i, hot_after=i == 0) for i in range(3)]
    assert not [c for c in concerns(model(hot_ends=True), demos, CLIMBED) if "at odds" in c.text]


@pytest.mark.parametrize(
    ("expression", "said"),
    [
        ("(<= robot.fingers_open 0.5)", "fingers open of the robot {} at most 0.5"),
        ("(not (<= robot.fingers_open 0.5))", "fingers open of the robot {} above 0.5"),
        ("(forall (<= robot.fingers_open 2))", "for every object: fingers open of the robot at most 2"),
        ("(not (forall (<= robot.fingers_open 2)))", "not for every object: fingers open of the robot at most 2"),
    ],
)
def test_formulas_of_the_grammar_are_said_in_words(expression: str, said: str) -> None:
    robot = Type("robot", ("fingers_open",))
    places = () if "forall" in expression else (robot,)
    formula = Predicate("[[0:robot].fingers_open<=[idx_0]0.5]", places, FromFeatures(expression))
    named = Predicate("Closed", places, FromFeatures(expression))
    meet = Skill("Meet", (robot, robot))
    variables = Variable("?x0", robot), Variable("?x1", robot)
    used = frozenset(LiftedAtom(p, variables[1 : 1 + len(places)]) for p in (formula, named))
    op = Operator("Op0", variables, used, frozenset(), frozenset(), meet, variables)
    assert set(spoken(op).needs) == {said.format(2), "Closed(robot 2)" if places else "Closed()"}
    (sentence,) = sentences([op])
    assert said.format(2) in sentence and "[" not in sentence
