from __future__ import annotations

from collections.abc import Callable

import pytest

from pix2pred.domains.burger.environment import HORIZON, BurgerEnvironment
from pix2pred.domains.burger.vocabulary import COOK, ON, PICK, SHARED, make_object
from pix2pred.domains.burger.world import BurgerWorld, Cell
from pix2pred.structs import Action, Skill
from pix2pred.structs.environment import Step, StepStatus

Run = Callable[..., Step]
DONE, STUCK = StepStatus.DONE, StepStatus.STUCK


def test_cook_and_stack(episode: BurgerEnvironment, run: Run) -> None:
    for skill, *names in (
        ("Pick", "patty1"), ("Place", "patty1", "grill"), ("Cook", "patty1", "grill"), ("Pick", "patty1"),
        ("Place", "patty1", "bottom_bun1"),
    ):  # fmt: skip
        assert run(skill, *names).status is DONE
    patty = episode.world.thing("patty1")
    assert (patty.cell, patty.z, patty.prepared) == (Cell(2, 0), 1, True)


def test_chop(episode: BurgerEnvironment, run: Run) -> None:
    assert run("Pick", "lettuce1").status is DONE
    assert run("Place", "lettuce1", "cutting_board").status is DONE
    assert run("Chop", "lettuce1", "cutting_board").status is DONE
    assert episode.world.thing("lettuce1").prepared


def test_picking_a_covered_item_lifts_the_wrong_one_and_never_ends(episode: BurgerEnvironment, run: Run) -> None:
    step = run("Pick", "bottom_bun1")
    assert step.status is STUCK
    assert "patty1 lay on bottom_bun1" in step.detail
    assert episode.world.held != "bottom_bun1"


def test_picking_with_a_full_hand_drops_the_item_on_the_target(run: Run, episode: BurgerEnvironment) -> None:
    run("Pick", "patty1")
    step = run("Pick", "patty2")
    assert step.status is STUCK
    assert "already held patty1" in step.detail
    assert episode.world.held in (None, "patty1")
    assert episode.world.thing("patty1").cell != Cell(2, 0)


def test_placing_on_a_covered_object_never_ends(run: Run) -> None:
    run("Pick", "lettuce1")
    step = run("Place", "lettuce1", "bottom_bun1")
    assert step.status is STUCK
    assert "patty1 lay on bottom_bun1" in step.detail


def test_placing_what_is_not_held_never_ends(run: Run) -> None:
    step = run("Place", "patty1", "grill")
    assert step.status is STUCK
    assert "not held" in step.detail


@pytest.mark.parametrize("patty", ["patty1", "patty2"])
def test_cooking_off_the_grill_never_ends(episode: BurgerEnvironment, run: Run, patty: str) -> None:
    step = run("Cook", patty, "grill")
    assert step.status is STUCK
    assert "directly on grill" in step.detail
    assert not episode.world.thing(patty).prepared


def test_cooking_a_held_patty_never_ends(run: Run) -> None:
    run("Pick", "patty1")
    assert run("Cook", "patty1", "grill").status is STUCK


@pytest.mark.parametrize("target", ["robot", "patty1"])
def test_placing_on_the_robot_or_itself_never_ends(run: Run, target: str) -> None:
    run("Pick", "patty1")
    step = run("Place", "patty1", target)
    assert step.status is STUCK
    assert "cannot be put on" in step.detail


def test_a_fulfilled_skill_ends_at_once(episode: BurgerEnvironment, run: Run) -> None:
    run("Pick", "patty1")
    steps = episode.steps
    assert run("Pick", "patty1").status is DONE
    assert episode.steps == steps


def test_strange_actions_get_stuck_and_never_raise(episode: BurgerEnvironment) -> None:
    robot, patty, lettuce = (
        make_object(n, t) for n, t in (("robot", "robot"), ("patty1", "patty"), ("lettuce1", "lettuce"))
    )
    grill, ghost = make_object("grill", "grill"), make_object("patty9", "patty")
    for action in (
        Action(COOK, (robot, lettuce, grill)), Action(PICK, (robot, ghost)), Action(PICK, (robot, grill)),
        Action(PICK, (patty, robot)), Action(PICK, ()), Action(Skill("Fly", ()), ()),
    ):  # fmt: skip
        step = episode.execute(action)
        assert step.status is STUCK
        assert step.detail
    assert episode.steps == 0


def test_the_horizon_ends_an_episode_and_reset_begins_another(episode: BurgerEnvironment, run: Run) -> None:
    while (step := run("Pick", "patty1")).status is DONE and run("Place", "patty1", "grill").status is DONE:
        pass
    if step.status is DONE:
        step = run("Place", "patty1", "grill")
    assert step.status is StepStatus.HORIZON
    assert episode.steps == HORIZON
    episode.reset()
    assert episode.steps == 0
    assert run("Pick", "patty1").status is DONE


def test_goal_is_evaluated_in_the_world(kitchen: BurgerWorld) -> None:
    patty, bun = make_object("patty1", "patty"), make_object("bottom_bun1", "bottom_bun")
    assert BurgerEnvironment(kitchen, SHARED, (ON(patty, bun),)).goal_reached()
    assert not BurgerEnvironment(kitchen, SHARED, (ON(bun, patty),)).goal_reached()
