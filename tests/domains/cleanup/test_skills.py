from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest

from extras import need
from pix2pred.domains.cleanup import CleanupDomain
from pix2pred.domains.cleanup.scenes import FLOOR, NARROW, TABLE, WIDE, CleanupScene, make_world
from pix2pred.domains.home.episode import HORIZON, HomeEnvironment
from pix2pred.domains.home.places import in_bin, on_floor, on_table, things_in
from pix2pred.domains.home.world import Body, World
from pix2pred.structs import Action
from pix2pred.structs.environment import Step, StepStatus

pytestmark = need("mujoco", extra="sim")

RULES = CleanupDomain().rules
DONE, STUCK = StepStatus.DONE, StepStatus.STUCK


def episode(things: Mapping[str, str], **plan: object) -> HomeEnvironment:
    world = make_world(CleanupScene(things, **plan), Body.ROBOT, "office", np.random.default_rng(1))  # type: ignore[arg-type]
    return HomeEnvironment(RULES, world, ())


def run(environment: HomeEnvironment, skill: str, *names: str) -> Step:
    objects = {o.name: o for o in RULES.objects(environment.world)}
    return environment.execute(Action(RULES.skills[skill], tuple(objects[n] for n in ("robot", *names))))


def test_clearing_wiping_and_putting_away() -> None:
    env = episode({"ball": TABLE, "eraser": FLOOR})
    assert on_table(env.world, "ball", TABLE) and on_floor(env.world, "eraser")
    assert run(env, "PickFromTop", "ball", TABLE).status is DONE
    assert env.world.holding == "ball" and not on_table(env.world, "ball", TABLE)
    assert run(env, "PlaceInside", "ball", WIDE).status is DONE
    assert in_bin(env.world, "ball", WIDE) and env.world.holding is None
    assert run(env, "PickFromFloor", "eraser").status is DONE
    assert run(env, "WipeAndContinueHoldingEraser", "eraser", TABLE).status is DONE
    assert env.world.thing(TABLE).strokes == () and env.world.holding == "eraser"


def test_a_dumped_bin_spills_everything_onto_the_floor() -> None:
    env = episode({"ball": NARROW, "duck": NARROW, "eraser": NARROW})
    assert len(things_in(env.world, NARROW)) == 3
    assert run(env, "DumpContentsOntoFloor", NARROW).status is DONE
    assert things_in(env.world, NARROW) == ()
    assert all(on_floor(env.world, n) for n in ("ball", "duck", "eraser"))
    places = [env.world.thing(n).at for n in ("ball", "duck", "eraser")]
    assert all(np.linalg.norm(np.subtract(a, b)) > 0.03 for i, a in enumerate(places) for b in places[:i])


def test_wiping_around_what_stands_on_the_table_leaves_scribbles() -> None:
    env = episode({"ball": TABLE, "eraser": FLOOR})
    run(env, "PickFromFloor", "eraser")
    step = run(env, "WipeAndContinueHoldingEraser", "eraser", TABLE)
    assert step.status is STUCK and "ball stands in the eraser's way" in step.detail
    assert 0 < len(env.world.thing(TABLE).strokes) < 5, "some are wiped, those around the ball are not"


Change = Callable[[World], World]


def same(world: World) -> World:
    return world


@pytest.mark.parametrize(
    ("first", "change", "then", "why"),
    [
        (None, same, ("PickFromTop", "eraser", TABLE), "does not lie on desk"),
        (None, same, ("PickFromFloor", "ball"), "does not lie on the floor"),
        (None, same, ("PickFromTop", "car", NARROW), "too narrow to reach into"),
        (None, same, ("PickFromTop", "ball", WIDE), "is not in wide_bin"),
        (None, same, ("PlaceInside", "ball", WIDE), "ball is not held"),
        (None, same, ("DumpContentsOntoFloor", WIDE), "nothing in wide_bin to dump"),
        (None, same, ("WipeAndContinueHoldingEraser", "eraser", TABLE), "eraser is not held"),
        (("PickFromFloor", "eraser"), same, ("PickFromTop", "ball", TABLE), "already holds eraser"),
        (("PickFromFloor", "eraser"), same, ("DumpContentsOntoFloor", NARROW), "already holds eraser"),
        (("PickFromTop", "ball", TABLE), same, ("WipeAndContinueHoldingEraser", "ball", TABLE), "wipes nothing off"),
        (("PickFromTop", "ball", TABLE), same, ("PlaceInside", "eraser", WIDE), "is not held, ball is"),
        (None, lambda w: w.with_thing(replace(w.thing("ball"), at=(2.5, 1.0, 0.05))),
         ("PickFromFloor", "ball"), "out of reach"),
        (("PickFromTop", "ball", TABLE), lambda w: w.with_thing(replace(w.thing(WIDE), at=(2.5, -1.0, 0.0))),
         ("PlaceInside", "ball", WIDE), "wide_bin is out of reach"),
        (("PickFromTop", "ball", TABLE), lambda w: w.with_thing(replace(w.thing(WIDE), opened=False)),
         ("PlaceInside", "ball", WIDE), "lid of wide_bin is closed"),
        (("PickFromFloor", "eraser"), lambda w: w.with_thing(replace(w.thing(TABLE), at=(2.6, 0.0, 0.0))),
         ("WipeAndContinueHoldingEraser", "eraser", TABLE), "desk is out of reach"),
    ],
)  # fmt: skip
def test_what_cannot_work_fails_with_its_cause(
    first: tuple[str, ...] | None, change: Change, then: tuple[str, ...], why: str
) -> None:
    env = episode({"ball": TABLE, "eraser": FLOOR, "car": NARROW})
    if first:
        assert run(env, *first).status is DONE
    env.world = change(env.world)
    before = env.world
    step = run(env, *then)
    assert step.status is STUCK and why in step.detail
    assert env.world == before


def test_a_full_bin_takes_nothing_more() -> None:
    env = episode({"ball": NARROW, "bottle": NARROW, "carton": NARROW, "duck": FLOOR})
    full = env.world.with_thing(replace(env.world.thing("bottle"), at=(*env.world.thing(NARROW).at[:2], 0.315)))
    env.world = full
    run(env, "PickFromFloor", "duck")
    env.world = full.with_thing() if env.world.holding is None else replace(full, holding="duck")
    step = run(env, "PlaceInside", "duck", NARROW)
    assert step.status is STUCK and "narrow_bin is full" in step.detail


def test_things_of_other_kinds_and_endless_episodes_are_refused() -> None:
    env = episode({"ball": TABLE, "eraser": FLOOR})
    objects = {o.name: o for o in RULES.objects(env.world)}
    wrong = Action(RULES.skills["PickFromFloor"], (objects["robot"], objects[TABLE]))
    step = env.execute(wrong)
    assert step.status is STUCK and "cannot be run" in step.detail
    env.steps = HORIZON
    assert run(env, "PickFromFloor", "eraser").status is StepStatus.HORIZON
    env.reset()
    assert run(env, "PickFromFloor", "eraser").status is DONE
