"""What a skill does to the things it was shown with, it is tried with others when there is no plan without."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.execution.analogies import SUFFIX, plan_by_analogy
from pix2pred.planning import AStar, Planner
from pix2pred.structs import (
    AbstractState,
    Atom,
    FromDomain,
    LiftedAtom,
    Object,
    Operator,
    PlanResult,
    PlanStatus,
    Predicate,
    Skill,
    Type,
    Variable,
)

ITEM = Type("item")
PATTY, BUN = Type("patty", parent=ITEM), Type("bun", parent=ITEM)
HELD, FREE = Predicate("Held", (ITEM,), FromDomain()), Predicate("Free", (), FromDomain())
ASIDE, RAW = Predicate("Aside", (ITEM,), FromDomain()), Predicate("Raw", (PATTY,), FromDomain())
PUT = Skill("Put", (ITEM,))
P = Variable("?p", PATTY)
PUT_PATTY = Operator(
    "PutPatty", (P,),
    frozenset({LiftedAtom(HELD, (P,)), LiftedAtom(RAW, (P,))}),
    frozenset({LiftedAtom(ASIDE, (P,)), LiftedAtom(FREE, ())}),
    frozenset({LiftedAtom(HELD, (P,))}),
    PUT, (P,),
)  # fmt: skip
PATTY_1, BUN_1 = Object("patty1", PATTY), Object("bun1", BUN)
GOAL = (FREE(),)


def planned(seen: AbstractState, operators: Sequence[Operator] = (PUT_PATTY,)) -> PlanResult:
    def plan(known: Sequence[Operator], state: AbstractState) -> PlanResult:
        return Planner(AStar()).plan(known, (PATTY_1, BUN_1), state, GOAL)

    return plan_by_analogy(plan, operators, (PATTY_1, BUN_1), seen)


def test_a_bun_is_put_aside_as_patties_were_and_need_not_be_raw() -> None:
    (step,) = planned(frozenset({HELD(BUN_1)})).plan
    assert (str(step), step.skill_objects) == (f"PutPatty{SUFFIX}(bun1)", (BUN_1,))
    assert step.preconditions == {HELD(BUN_1)} and step.delete == {HELD(BUN_1)}
    assert step.add == {ASIDE(BUN_1), FREE()}


def test_what_a_patty_needs_is_not_got_round_by_analogy() -> None:
    held: frozenset[Atom] = frozenset({HELD(PATTY_1)})
    assert planned(held).status == PlanStatus.UNSOLVABLE
    (step,) = planned(held | {RAW(PATTY_1)}).plan
    assert step.operator is PUT_PATTY


def test_operators_about_all_things_of_a_skill_have_no_analogy() -> None:
    x = Variable("?x", ITEM)
    general = Operator(
        "Put", (x,), frozenset({LiftedAtom(HELD, (x,))}), frozenset({LiftedAtom(FREE, ())}), frozenset(), PUT, (x,)
    )
    assert planned(frozenset({HELD(BUN_1)}), (general,)).status == PlanStatus.UNSOLVABLE
