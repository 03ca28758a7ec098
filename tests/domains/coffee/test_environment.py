from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from pix2pred.domains.coffee.classifiers import AboveCup, true_atoms
from pix2pred.domains.coffee.environment import HORIZON, CoffeeEnvironment
from pix2pred.domains.coffee.simulation.geometry import CUP_CAPACITIES, FULL_JUG, TABLE_Z, Point
from pix2pred.domains.coffee.vocabulary import CUP_FILLED, GIVEN, PICK_JUG, POUR, SKILL_OF, make_object
from pix2pred.domains.coffee.world import CoffeeWorld, Cup
from pix2pred.structs import Action, Skill
from pix2pred.structs.environment import Step, StepStatus

Run = Callable[..., Step]
DONE, STUCK = StepStatus.DONE, StepStatus.STUCK
FILL = (
    ("PickJug", "jug"), ("PlaceJugInMachine", "jug", "coffee_machine"), ("TurnMachineOnAndFill", "coffee_machine"),
    ("PickJug", "jug"),
)  # fmt: skip


def atoms(world: CoffeeWorld, above: AboveCup = AboveCup.ANYWHERE) -> set[str]:
    return {str(a) for a in true_atoms(world, GIVEN, above)} - {"NotSameCup(cup0, cup1)", "NotSameCup(cup1, cup0)"}


def test_filling_two_cups(episode: CoffeeEnvironment, run: Run) -> None:
    start = {"HandEmpty(robot)", "JugPickable(jug)", "NotAboveCup(robot, jug)", "OnTable(jug)"}
    assert atoms(episode.world) == start
    above = {"JugAboveCup(jug, cup0)", "JugAboveCup(jug, cup1)", "RobotAboveCup(robot, cup0)",
             "RobotAboveCup(robot, cup1)", "Holding(robot, jug)"}  # fmt: skip
    seen = []
    for skill, *names in (*FILL, ("PourSomeLiquid", "jug", "cup1"), ("PourSomeLiquid", "jug", "cup0")):
        assert run(skill, *names).status is DONE
        seen.append(atoms(episode.world))
    in_machine = start - {"OnTable(jug)"}
    assert seen == [
        above | {"JugPickable(jug)"}, in_machine, in_machine | {"PressingButton(robot, coffee_machine)"},
        above | {"JugPickable(jug)"}, above | {"CupFilled(cup1)"}, above | {"CupFilled(cup0)", "CupFilled(cup1)"},
    ]  # fmt: skip
    world = episode.world
    assert math.isclose(world.jug.level + sum(c.current for c in world.cups), FULL_JUG)


def test_a_jug_is_above_the_cup_under_its_spout_alone_when_the_switch_says_so(
    kitchen_table: CoffeeWorld, run: Run, episode: CoffeeEnvironment
) -> None:
    for skill, *names in FILL:
        run(skill, *names)
    assert "NotAboveCup(robot, jug)" in atoms(episode.world, AboveCup.NEAR)
    run("PourSomeLiquid", "jug", "cup1")
    now = atoms(episode.world, AboveCup.NEAR)
    assert {"JugAboveCup(jug, cup1)", "RobotAboveCup(robot, cup1)"} <= now
    assert not {"JugAboveCup(jug, cup0)", "NotAboveCup(robot, jug)"} & now


@pytest.mark.parametrize("degrees", [50, -50, 120, -120, 179])
def test_a_handle_turned_away_cannot_be_gripped_until_the_jug_is_rotated(
    episode: CoffeeEnvironment, run: Run, degrees: float
) -> None:
    world = episode.world
    episode.world = replace(world, jug=replace(world.jug, rot=math.radians(degrees)))
    step = run("PickJug", "jug")
    assert step.status is STUCK and "handle is turned away" in step.detail
    assert not episode.world.jug.held
    assert run("RotateItemUntilHandleAccessible", "jug").status is DONE
    assert abs(episode.world.jug.rot) < 1e-6
    assert run("PickJug", "jug").status is DONE


def test_six_of_the_largest_cups_are_filled_from_one_jug(kitchen_table: CoffeeWorld) -> None:
    largest = max(CUP_CAPACITIES)
    cups = tuple(Cup(f"cup{i}", 0.62 + 0.07 * i, 1.2, largest) for i in range(6))
    episode = CoffeeEnvironment(replace(kitchen_table, cups=cups), GIVEN, (), AboveCup.ANYWHERE)
    robot, jug = make_object("robot", "robot"), make_object("jug", "jug")
    for skill, *names in FILL:
        assert episode.execute(
            Action(SKILL_OF[skill], (robot, *(make_object(n, n) for n in names)))
        ).status is DONE  # fmt: skip
    for cup in cups:
        assert episode.execute(Action(POUR, (robot, jug, make_object(cup.name, "cup")))).status is DONE
    assert all(c.filled for c in episode.world.cups)


def test_placing_or_pouring_without_the_jug_fails(run: Run) -> None:
    for skill, *names in (("PlaceJugInMachine", "jug", "coffee_machine"), ("PourSomeLiquid", "jug", "cup0")):
        step = run(skill, *names)
        assert step.status is STUCK and "the jug was not held" in step.detail


def test_the_machine_fills_nothing_without_a_jug_but_its_lamp_lights(episode: CoffeeEnvironment, run: Run) -> None:
    step = run("TurnMachineOnAndFill", "coffee_machine")
    assert step.status is STUCK and "no jug stood under the dispenser" in step.detail
    assert episode.world.machine_on and episode.world.jug.level == 0


def test_a_hand_with_the_jug_presses_no_button(episode: CoffeeEnvironment, run: Run) -> None:
    run("PickJug", "jug")
    step = run("TurnMachineOnAndFill", "coffee_machine")
    assert step.status is STUCK and "held the jug" in step.detail
    assert not episode.world.machine_on


def test_pouring_from_an_empty_jug_fails(episode: CoffeeEnvironment, run: Run) -> None:
    run("PickJug", "jug")
    step = run("PourSomeLiquid", "jug", "cup0")
    assert step.status is STUCK and "ran empty" in step.detail
    assert episode.world.cup("cup0").current == 0


def test_out_of_reach_is_said(episode: CoffeeEnvironment, run: Run) -> None:
    world = episode.world
    far = Point(5.0, 5.0, TABLE_Z)
    episode.world = replace(world, jug=replace(world.jug, at=far))
    for skill in ("PickJug", "RotateItemUntilHandleAccessible"):
        if skill.startswith("Rotate"):
            episode.world = replace(episode.world, jug=replace(episode.world.jug, rot=1.0))
        step = run(skill, "jug")
        assert step.status is STUCK and "reach" in step.detail
    episode.world = world.with_cup(replace(world.cup("cup0"), x=-3.0))
    for skill, *names in FILL:
        run(skill, *names)
    step = run("PourSomeLiquid", "jug", "cup0")
    assert step.status is STUCK and "cup0 is out of the gripper's reach" in step.detail


def test_a_cup_takes_no_more_than_it_holds(episode: CoffeeEnvironment, run: Run) -> None:
    for skill, *names in FILL:
        run(skill, *names)
    run("PourSomeLiquid", "jug", "cup0")
    for _ in range(3):
        run("PourSomeLiquid", "jug", "cup0")
    cup = episode.world.cup("cup0")
    assert cup.target < cup.current <= cup.capacity


def test_a_fulfilled_skill_ends_at_once(episode: CoffeeEnvironment, run: Run) -> None:
    run("PickJug", "jug")
    steps = episode.steps
    assert run("PickJug", "jug").status is DONE
    assert run("RotateItemUntilHandleAccessible", "jug").status is DONE
    assert episode.steps == steps


def test_strange_actions_get_stuck_and_never_raise(episode: CoffeeEnvironment) -> None:
    robot, jug, cup = (make_object(n, t) for n, t in (("robot", "robot"), ("jug", "jug"), ("cup0", "cup")))
    ghost = make_object("cup9", "cup")
    for action in (
        Action(POUR, (robot, jug, ghost)), Action(POUR, (robot, cup, jug)), Action(PICK_JUG, ()),
        Action(PICK_JUG, (robot, jug), (math.nan,)), Action(Skill("Fly", ()), ()),
    ):  # fmt: skip
        step = episode.execute(action)
        assert step.status is STUCK
        assert step.detail
    assert episode.steps == 0


def test_the_horizon_ends_an_episode_and_reset_begins_another(episode: CoffeeEnvironment, run: Run) -> None:
    statuses = {DONE}
    while StepStatus.HORIZON not in statuses:
        statuses = {run(skill, *names).status for skill, *names in FILL[:2]}
    assert episode.steps == HORIZON
    episode.reset()
    assert episode.steps == 0
    assert run("PickJug", "jug").status is DONE


def test_without_cups_a_goal_over_none_holds_and_skills_still_run(kitchen_table: CoffeeWorld) -> None:
    episode = CoffeeEnvironment(replace(kitchen_table, cups=()), GIVEN, (), AboveCup.ANYWHERE)
    assert episode.goal_reached()
    robot, jug = make_object("robot", "robot"), make_object("jug", "jug")
    assert episode.execute(Action(PICK_JUG, (robot, jug))).status is DONE
    assert "NotAboveCup(robot, jug)" in atoms(episode.world)


def test_goal_is_evaluated_in_the_world(kitchen_table: CoffeeWorld) -> None:
    goal = (CUP_FILLED(make_object("cup0", "cup")),)
    full = kitchen_table.with_cup(replace(kitchen_table.cup("cup0"), current=0.7))
    assert not CoffeeEnvironment(kitchen_table, GIVEN, goal, AboveCup.ANYWHERE).goal_reached()
    assert CoffeeEnvironment(full, GIVEN, goal, AboveCup.ANYWHERE).goal_reached()
