"""What a skill needs not to hold, what the goal says of last labels, and one word in the place of two."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from learning.random_tables import candidate, demo, given, table
from pix2pred.learning import LearningSettings, hill_climbing
from pix2pred.learning.operators.robust import Robust
from pix2pred.learning.selection.projections import is_contrary
from pix2pred.learning.transitions import IndexedTable
from pix2pred.structs import Action, FromVLM, Label, LabelledDemo, Object, Predicate, Skill, TruthTable, Type

BOX, BALL = Type("box"), Type("ball")
PUT, SHUT, SEND = Skill("Put", (BALL, BOX)), Skill("Shut", (BOX,)), Skill("Send", (BOX, BALL))
IN, SENT = given("In", BALL, BOX), given("Sent", BALL)
CLOSED, OPEN = candidate("closed", BOX), candidate("open", BOX)
ROBUST = LearningSettings()


def parcel(number: int, wrong: int = 0) -> LabelledDemo:
    """A ball is put into an open box, which is shut and sent; ``wrong`` labels of "open" are turned round."""
    ball, box, other = Object("ball", BALL), Object("box", BOX), Object("other", BOX)
    states = [
        [OPEN(box), OPEN(other)],
        [IN(ball, box), OPEN(box), OPEN(other)],
        [IN(ball, box), CLOSED(box), OPEN(other)],
        [SENT(ball), CLOSED(box), OPEN(other)],
    ]
    actions = [Action(PUT, (ball, box)), Action(SHUT, (box,)), Action(SEND, (box, ball))]
    made = demo(f"d{number}", {ball, box, other}, actions, states, [SENT(ball)])
    values = made.values.copy()
    values[:wrong, made.atoms.index(OPEN(other))] = 0
    return replace(made, values=values)


def parcels(pool: tuple[Predicate, ...] = (CLOSED, OPEN), wrong: int = 0) -> TruthTable:
    return table([IN, SENT], pool, [parcel(i, wrong if i == 0 else 0) for i in range(8)])


def test_that_a_skill_needs_a_predicate_not_to_hold_is_said_by_the_word_for_the_contrary() -> None:
    """J alone sees little in it: a plan that shuts the box first is as long."""
    selection = hill_climbing(parcels(), ROBUST).run()
    put = next(op for op in selection.operators if op.skill == PUT)
    assert {p.name for p in selection.selected} == {"closed", "open"}
    assert [a.predicate for a in put.preconditions] == [OPEN]


def test_a_contrary_that_only_what_makes_the_predicate_true_needs_is_left_out() -> None:
    """That a box is open before it is shut goes without saying."""

    def sent_empty(number: int) -> LabelledDemo:
        ball, box = Object("ball", BALL), Object("box", BOX)
        states = [[OPEN(box)], [CLOSED(box)], [SENT(ball), CLOSED(box)]]
        return demo(f"d{number}", {ball, box}, [Action(SHUT, (box,)), Action(SEND, (box, ball))], states, [SENT(ball)])

    selection = hill_climbing(table([IN, SENT], [CLOSED, OPEN], [sent_empty(i) for i in range(8)]), ROBUST).run()
    assert [p.name for p in selection.selected] == ["closed"]


def test_a_contrary_that_several_skills_are_never_used_against_tells_when_they_come() -> None:
    """That a box is wrapped while it is open is no rule of the world: all is done before it is shut."""
    wrap, wrapped = Skill("Wrap", (BALL, BOX)), given("Wrapped", BALL)

    def wrapped_parcel(number: int) -> LabelledDemo:
        ball, box = Object("ball", BALL), Object("box", BOX)
        actions = [Action(wrap, (ball, box)), Action(PUT, (ball, box)), Action(SHUT, (box,)), Action(SEND, (box, ball))]
        facts = [OPEN(box)], [OPEN(box), IN(ball, box)], [CLOSED(box), IN(ball, box)], [CLOSED(box), SENT(ball)]
        states = [[OPEN(box)], *([*there, wrapped(ball)] for there in facts)]
        return demo(f"d{number}", {ball, box}, actions, states, [SENT(ball), wrapped(ball)])

    demos = [wrapped_parcel(i) for i in range(8)]
    selection = hill_climbing(table([IN, SENT, wrapped], [CLOSED, OPEN], demos), ROBUST).run()
    assert [p.name for p in selection.selected] == ["closed"]


@pytest.mark.parametrize(("wrong", "errors", "expected"), [(0, 0.0, True), (1, 0.0, False), (1, 0.02, True)])
def test_contraries_may_agree_in_a_few_values(wrong: int, errors: float, expected: bool) -> None:
    data = IndexedTable(parcels(wrong=wrong))
    number = {p: i for i, p in enumerate(data.predicates)}
    assert is_contrary(data, number[CLOSED], number[OPEN], errors) is expected
    assert not is_contrary(data, number[CLOSED], number[SENT], errors)


@pytest.mark.parametrize("said", [Label.FALSE, Label.UNKNOWN])
def test_a_demonstration_reaches_its_goal_whatever_its_last_label_says(said: Label) -> None:
    seen = Predicate("Sent", (BALL,), FromVLM("Sent"))
    demos = []
    for i in range(8):
        one = parcel(i)
        values, goal = one.values.astype(np.int8), one.atoms.index(SENT(Object("ball", BALL)))
        values[-1, goal] = said if i < 4 else Label.TRUE
        atoms = tuple(seen(*a.objects) if a.predicate == SENT else a for a in one.atoms)
        demos.append(replace(one, values=values, atoms=atoms, goal=(seen(Object("ball", BALL)),)))
    data = Robust().fit(IndexedTable(table([IN, seen], [CLOSED, OPEN], demos))).data
    p = data.predicates.index(seen)
    assert all(data.extension(d, 3, p) and not data.extension(d, 2, p) for d in range(8))
