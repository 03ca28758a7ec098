"""Every rule of method 9 for reading a written plan: what is skipped, what is dropped, where reading stops."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pix2pred.approaches.parse_plan import NoPlanError, WrittenPlan, parse_plan
from pix2pred.structs import Object, Skill, Type

ITEM = Type("item")
PATTY = Type("patty", (), ITEM)
ROBOT = Type("robot")
R, P1, CUP = Object("r1", ROBOT, "robot"), Object("p1", PATTY, "small patty"), Object("c", ITEM, "cup")
PICK = Skill("Pick", (ROBOT, ITEM))
FRY = Skill("Fry", (ROBOT, PATTY))
PUSH = Skill("Push", (ROBOT, ITEM), (-1.0, 0.0), (1.0, 3.14))
WAIT = Skill("Wait", ())


def read(*lines: str, head: str = "Reasoning.\nPlan:\n") -> WrittenPlan:
    return parse_plan(head + "\n".join(lines), (PICK, FRY, PUSH, WAIT), (ITEM, PATTY, ROBOT), (R, P1, CUP))


def names(plan: WrittenPlan) -> list[str]:
    return [str(a) for a in plan.actions]


GOOD = "Pick(robot:robot, small_patty:patty)[]"


def test_skills_with_and_without_numbers_are_read() -> None:
    plan = read(GOOD, "Push(robot:robot, cup:item)[-0.5, 1e0]", "Wait()[]")
    assert names(plan) == ["Pick(r1, p1)", "Push(r1, c)[-0.5, 1.0]", "Wait()"]
    assert plan.dropped == () and plan.stopped == ""


@pytest.mark.parametrize("head", ["Plan:\n", "**Plan:**\n", "## Plan:\n", "so\n  PLAN :  \n", "Plan:\nPlan:\n"[:6]])
def test_the_plan_begins_after_the_line_that_says_so(head: str) -> None:
    assert names(read(GOOD, head=head)) == ["Pick(r1, p1)"]


def test_what_stands_before_the_plan_is_not_read() -> None:
    assert names(read(GOOD, head=f"{GOOD}\nMy plan: pick.\nPlan:\n")) == ["Pick(r1, p1)"]


@pytest.mark.parametrize("answer", ["", GOOD, "The plan: Pick", "Plans:\n" + GOOD])
def test_no_plan_is_a_failure_and_not_an_empty_plan(answer: str) -> None:
    with pytest.raises(NoPlanError):
        parse_plan(answer, (PICK,), (ITEM,), (R,))


def test_an_empty_plan_is_a_plan() -> None:
    assert read("", "  ") == WrittenPlan((), ())


def test_blank_lines_and_numbering_are_skipped() -> None:
    assert names(read("", f"1. {GOOD}", "   ", f"- {GOOD}", f"2) `{GOOD}`")) == ["Pick(r1, p1)"] * 3


@pytest.mark.parametrize(
    "line",
    ["Grab(robot:robot, cup:item)[]", "pick(robot:robot, cup:item)[]", "Pick robot cup", "Pick(robot:robot, cup:item)",
     "Pick[robot:robot]", "Done.", "Push(robot:robot, cup:item)[1]", "Push(robot:robot, cup:item)[1, 2, 3]",
     "Push(robot:robot, cup:item)[]", "Pick(robot:robot, cup:item)[0.5]"],
)  # fmt: skip
def test_an_unknown_skill_a_missing_bracket_or_too_few_numbers_end_the_plan(line: str) -> None:
    plan = read(GOOD, line, GOOD)
    assert names(plan) == ["Pick(r1, p1)"] and line in plan.stopped


@pytest.mark.parametrize(
    "line",
    ["Pick(robot, cup)[]", "Pick(robot:robot; cup:item)[]", "Pick(robot:robot, spoon:item)[]",
     "Pick(robot:robot, cup:spoon)[]", "Fry(robot:robot, cup:item)[]", "Pick(robot:robot)[]",
     "Pick(robot:robot, cup:item, cup:item)[]", "Pick()[]", "Push(robot:robot, cup:item)[left, 1]",
     "Push(robot:robot, cup:item)[1,]", "Push(robot:robot, cup:item)[nan, 1]", "Push(robot:robot, cup:item)[1, 1e999]",
     "Pick(robot:robot, cup:item[]"],
)  # fmt: skip
def test_a_line_that_is_wrong_in_itself_is_dropped_and_reading_goes_on(line: str) -> None:
    plan = read(line, GOOD)
    assert names(plan) == ["Pick(r1, p1)"]
    assert len(plan.dropped) == 1 and plan.dropped[0].startswith(line) and plan.stopped == ""


def test_an_object_counts_by_its_own_type_whatever_known_type_the_line_says() -> None:
    assert names(read("Fry(robot:robot, small_patty:item)[]")) == ["Fry(r1, p1)"]


@given(st.text())
def test_any_text_gives_a_plan_or_says_that_there_is_none(text: str) -> None:
    assert all(a.skill in (PICK, FRY, PUSH, WAIT) for a in read(text).actions)
