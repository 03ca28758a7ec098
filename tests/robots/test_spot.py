"""The client's Spot over gRPC and TLS: skills of Cleanup and Juice that change the world, ways out that are safe."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from extras import need
from pix2pred.structs import Action, Task, parse_application
from pix2pred.structs.environment import Step, StepStatus
from pix2pred.structs.space.poses import FloorPose

pytestmark = [need("bosdyn.client", "pyapriltags", extra="spot"), need("mujoco", extra="sim")]


def task_of(domain: str, family: str, index: int) -> Task:
    from pix2pred.structs import State
    from robots.simulated_spots import DOMAINS

    made = DOMAINS[domain]
    start = made.start(family, 0, index)
    return Task("test", made.rules.objects(start.world), State((), {}), made.goal_of(start))


def action(domain: str, task: Task, text: str) -> Action:
    from robots.simulated_spots import DOMAINS

    applied = parse_application(text)
    by_name = {o.name: o for o in task.objects}
    return Action(DOMAINS[domain].rules.skills[applied.name], tuple(by_name[n] for n in applied.args))


def run(server: Any, domain: str, task: Task, skills: Sequence[str]) -> list[Step]:
    from robots.simulated_spots import spot_for

    with spot_for(server, domain, task) as spot:
        spot.start()
        steps = []
        for text in skills:
            spot.go_home()
            steps.append(spot.execute(action(domain, task, text)))
    assert server.spot.body.stowed, "the arm is put away"
    assert server.spot.body.leases.owner == "", "the lease is returned"
    assert not server.spot.body.powered
    return steps


@pytest.mark.parametrize(
    ("domain", "family", "index", "skills"),
    [
        (
            "cleanup", "new-objects", 0,
            ["PickFromTop(robot, carton, desk)", "PlaceInside(robot, carton, narrow_bin)",
             "PickFromFloor(robot, eraser)", "WipeAndContinueHoldingEraser(robot, eraser, desk)"],
        ),
        (
            "cleanup", "new-objects", 1,
            ["DumpContentsOntoFloor(robot, narrow_bin)", "PickFromFloor(robot, carton)",
             "PlaceInside(robot, carton, wide_bin)"],
        ),
        (
            "juice", "novel-goal-2", 0,
            ["PickContainer(robot, juice_cup)", "DumpFromOneIntoOther(robot, juice_cup, bowl)",
             "PlaceInsideJuiceValveRegion(robot, juice_cup, juicer)", "PickMovable(robot, {fruit})",
             "PlaceInside(robot, {fruit}, juicer)", "CloseLid(robot, juicer)",
             "TurnOnAndRunMachine(robot, juicer, juice_cup, waste_cup)"],
        ),
    ],
)  # fmt: skip
def test_skills_reach_the_goal_of_a_task_with_drift(
    tmp_path: Path, domain: str, family: str, index: int, skills: list[str]
) -> None:
    from robots.simulated_spots import DOMAINS, served

    task = task_of(domain, family, index)
    fruit = next((o.name for o in task.objects if o.type.name == "movable_object"), "")
    with served(tmp_path, domain, family, index, faults=["drift:0.05"]) as server:
        steps = run(server, domain, task, [s.format(fruit=fruit) for s in skills])
        assert [s.detail for s in steps if s.status is not StepStatus.DONE] == []
        world = server.spot.body.around.world  # type: ignore[attr-defined]
        assert all(DOMAINS[domain].rules.holds(world, atom) for atom in task.goal)


def test_a_view_has_what_the_simulation_shows_from_the_same_place(tmp_path: Path) -> None:
    from pix2pred.domains.home.cameras import pictures
    from robots.simulated_spots import DOMAINS, served, spot_for

    task = task_of("cleanup", "new-objects", 0)
    with served(tmp_path) as server, spot_for(server, "cleanup", task) as spot:
        spot.start()
        seen = {p.camera: p for p in spot.observe().pictures}
        there = {p.camera: p for p in pictures(DOMAINS["cleanup"].start("new-objects", 0, 0).world)}
    assert sorted(seen) == sorted(there)
    for camera, picture in there.items():
        difference = np.abs(seen[camera].image.pixels().astype(int) - picture.image.pixels()).mean()
        assert difference < 2.0, f"{camera}: the tags on the walls are all that differs"
        assert {n for n, b in picture.boxes.items() if b.width > 8 and b.height > 8} <= set(seen[camera].boxes)


def test_a_missed_grasp_is_a_failed_skill_and_not_the_end(tmp_path: Path) -> None:
    from robots.simulated_spots import served

    task = task_of("cleanup", "new-objects", 0)
    with served(tmp_path, faults=["grasp-miss:1"]) as server:
        (step,) = run(server, "cleanup", task, ["PickFromFloor(robot, eraser)"])
    assert step.status is StepStatus.STUCK and "grasp failed" in step.detail


def test_a_blocked_way_is_a_failed_skill_and_one_home_has_a_name(tmp_path: Path) -> None:
    from pix2pred.robots.robot import Outcome, RobotError
    from robots.simulated_spots import served, spot_for

    task = task_of("cleanup", "new-objects", 0)
    with served(tmp_path) as server, spot_for(server, "cleanup", task) as spot:
        spot.start()
        spot.go_home()
        spot.limbs.walk(spot.limbs.odometry().floor * FloorPose(-0.5))
        server.spot.do(lambda: setattr(server.spot.body.around, "stands", lambda place: False))
        step = spot.execute(action("cleanup", task, "PickFromTop(robot, carton, desk)"))
        with pytest.raises(RobotError) as raised:
            spot.observe()
    assert step.status is StepStatus.STUCK
    assert raised.value.outcome is Outcome.BLOCKED


@pytest.mark.parametrize(
    ("fault", "outcome"),
    [("lease-lost", "lease lost"), ("estop", "emergency stop"), ("fall", "fallen"), ("battery-empty", "battery empty")],
)
@pytest.mark.parametrize("moment", [8, 25])
def test_what_ends_the_work_has_a_name_and_is_over_at_once(
    tmp_path: Path, fault: str, outcome: str, moment: int
) -> None:
    from pix2pred.robots.robot import Outcome, RobotError
    from robots.simulated_spots import served, spot_for

    task = task_of("cleanup", "new-objects", 0)
    with served(tmp_path, faults=[f"{fault}@{moment}"]) as server:
        with pytest.raises(RobotError) as raised, spot_for(server, "cleanup", task) as spot:
            spot.start()
            for text in ("PickFromTop(robot, carton, desk)", "PlaceInside(robot, carton, narrow_bin)"):
                spot.go_home()
                spot.execute(action("cleanup", task, text))
                spot.observe()
        assert raised.value.outcome is Outcome(outcome)
        body = server.spot.body
        assert body.leases.owner in ("", "tablet"), "the lease is returned, or somebody else's"
        assert not body.moving and (body.stowed or not body.powered or fault == "lease-lost")


def test_a_silent_camera_ends_the_work_with_the_arm_away(tmp_path: Path) -> None:
    from dataclasses import replace

    from pix2pred.robots.robot import Outcome, RobotError
    from pix2pred.robots.spot.settings import SpotSettings
    from robots.simulated_spots import PATIENT, served, spot_for

    quick = SpotSettings(deadlines=replace(PATIENT, answer=3.0), poll=0.01, estop_timeout=90.0)
    task = task_of("cleanup", "new-objects", 0)
    with served(tmp_path, faults=["camera-timeout@6"]) as server:
        with pytest.raises(RobotError) as raised, spot_for(server, "cleanup", task, settings=quick) as spot:
            spot.start()
            spot.observe()
        assert raised.value.outcome is Outcome.CAMERA_SILENT
        assert server.spot.body.stowed and server.spot.body.leases.owner == ""


def test_an_interruption_at_any_time_leaves_it_safe(tmp_path: Path) -> None:
    from robots.simulated_spots import served, spot_for

    task = task_of("cleanup", "new-objects", 0)
    with served(tmp_path) as server:
        for moment in (1, 2, 4):
            with pytest.raises(KeyboardInterrupt), spot_for(server, "cleanup", task) as spot:
                spot.start()
                _interrupt_after(spot, moment)
                spot.go_home()
                spot.execute(action("cleanup", task, "PickFromFloor(robot, eraser)"))
                spot.observe()
            body = server.spot.body
            assert body.stowed and body.leases.owner == "" and not body.powered, moment


def _interrupt_after(spot: Any, calls: int) -> None:
    left, ask = [calls], spot.session.feedback

    def asked(number: int) -> Any:
        left[0] -= 1
        if left[0] == 0:
            raise KeyboardInterrupt
        return ask(number)

    spot.session.feedback = asked


def test_a_robot_that_holds_something_is_gone_on_with(tmp_path: Path) -> None:
    from pix2pred.robots.robot import RobotMemory
    from robots.simulated_spots import served, spot_for

    task = task_of("cleanup", "new-objects", 0)
    memory = RobotMemory(tmp_path / "map.json")
    with served(tmp_path) as server:
        with spot_for(server, "cleanup", task, memory) as spot:
            spot.start()
            spot.go_home()
            assert spot.execute(action("cleanup", task, "PickFromFloor(robot, eraser)")).status is StepStatus.DONE
        again = RobotMemory(tmp_path / "map.json", spot.holding)
        with spot_for(server, "cleanup", task, again) as spot:
            spot.start()
            told = {str(a) for a in spot.observe().given}
            assert told == {"Holding(robot, eraser)"}
            here = server.spot.body.place
            assert math.hypot(here.x, here.y) < 0.05, "home is where the map was begun"


def test_no_secret_reaches_a_message_or_a_repr(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    from pix2pred.robots.robot import RobotError
    from robots.simulated_spots import PASSWORD, served, session_with

    caplog.set_level(0)
    with served(tmp_path) as server:
        session = session_with(server, password=f"wrong-{PASSWORD}")
        with pytest.raises(RobotError) as raised:
            session.open()
        session.close()
    assert PASSWORD not in f"{raised.value}{raised.value!r}{session._who!r}{caplog.text}"
