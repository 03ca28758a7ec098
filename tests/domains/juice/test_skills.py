from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from extras import need
from pix2pred.domains.home.episode import HomeEnvironment
from pix2pred.domains.home.places import Region, in_hopper, in_region
from pix2pred.domains.home.world import Body, World
from pix2pred.domains.juice import JuiceDomain
from pix2pred.domains.juice.rules import juice_of
from pix2pred.domains.juice.scenes import JUICER, Cup, Plan, make_world
from pix2pred.structs import Action
from pix2pred.structs.environment import Step, StepStatus

pytestmark = need("mujoco", extra="sim")

RULES = JuiceDomain().rules
DONE, STUCK = StepStatus.DONE, StepStatus.STUCK
CUPS = {
    "juice_cup": Cup("glass", "juice"), "waste_cup": Cup("tumbler", "waste"), "tea_cup": Cup("mug", contents=("tea",)),
    "bowl": Cup("bowl"),
}  # fmt: skip


def episode(plan: Plan | None = None) -> HomeEnvironment:
    plan = plan or Plan(CUPS, ("orange", "apple", "melon"), ("apple",))
    return HomeEnvironment(RULES, make_world(plan, Body.ROBOT, "office", np.random.default_rng(2)), ())


def run(environment: HomeEnvironment, skill: str, *names: str) -> Step:
    objects = {o.name: o for o in RULES.objects(environment.world)}
    return environment.execute(Action(RULES.skills[skill], tuple(objects[n] for n in ("robot", *names))))


def test_juice_of_two_fruits() -> None:
    env = episode()
    assert in_hopper(env.world, "apple", JUICER) and not in_hopper(env.world, "orange", JUICER)
    for skill in (("PickMovable", "orange"), ("PlaceInside", "orange", JUICER), ("CloseLid", JUICER)):
        assert run(env, *skill).status is DONE
    assert in_hopper(env.world, "orange", JUICER)
    assert run(env, "TurnOnAndRunMachine", JUICER, "juice_cup", "waste_cup").status is DONE
    assert all(juice_of(env.world, fruit, "juice_cup") for fruit in ("orange", "apple"))
    assert not juice_of(env.world, "orange", "waste_cup") and env.world.thing("waste_cup").contents == ("pulp",)
    assert not any(in_hopper(env.world, fruit, JUICER) for fruit in ("orange", "apple"))


def test_a_cup_is_emptied_and_put_under_a_valve() -> None:
    env = episode(Plan(CUPS | {"waste_cup": Cup("tumbler", contents=("cola",))}))
    assert run(env, "PickContainer", "waste_cup").status is DONE
    assert run(env, "DumpFromOneIntoOther", "waste_cup", "bowl").status is DONE
    assert env.world.thing("bowl").contents == ("cola",) and not env.world.thing("waste_cup").contents
    assert run(env, "PlaceInsideWasteValveRegion", "waste_cup", JUICER).status is DONE
    assert in_region(env.world, "waste_cup", JUICER, Region.WASTE)


def machine(**changes: object) -> Callable[[World], World]:
    return lambda w: w.with_thing(replace(w.thing(JUICER), **changes))  # type: ignore[arg-type]


def moved(name: str, x: float, y: float) -> Callable[[World], World]:
    return lambda w: w.with_thing(replace(w.thing(name), at=(x, y, w.thing(name).at[2])))


def holding(name: str) -> Callable[[World], World]:
    return lambda w: replace(w, holding=name)


RUN = ("TurnOnAndRunMachine", JUICER, "juice_cup", "waste_cup")


@pytest.mark.parametrize(
    ("changes", "skill", "why"),
    [
        ((), RUN, "the lid of juicer is open"),
        ((machine(opened=False, powered=False),), RUN, "juicer has no power"),
        ((machine(opened=False), moved("apple", 0.7, 0.3)), RUN, "there is no fruit in juicer"),
        ((machine(opened=False), moved("waste_cup", 0.7, 0.5)), RUN, "waste_cup does not stand under the waste valve"),
        ((machine(opened=False), moved("juice_cup", 0.7, 0.5), moved("waste_cup", 0.7, 0.6)), RUN,
         "juice_cup does not stand under the juice valve"),
        ((machine(opened=False),), ("CloseLid", JUICER), "closed already"),
        ((machine(opened=False), holding("orange")), ("PlaceInside", "orange", JUICER), "lid of juicer is closed"),
        ((holding("melon"),), ("PlaceInside", "melon", JUICER), "melon is too large for juicer"),
        ((holding("orange"),), ("CloseLid", JUICER), "already holds orange"),
        ((), ("PickMovable", "apple"), "apple is inside juicer"),
        ((), ("PlaceInside", "orange", JUICER), "orange is not held"),
        ((holding("waste_cup"),), ("PlaceInsideJuiceValveRegion", "waste_cup", JUICER),
         "juice_cup stands under the juice valve already"),
        ((holding("waste_cup"),), ("DumpFromOneIntoOther", "waste_cup", "bowl"), "nothing in waste_cup to pour out"),
        ((holding("tea_cup"), lambda w: w.with_thing(replace(w.thing("bowl"), contents=("tea",), amount=0.8))),
         ("DumpFromOneIntoOther", "tea_cup", "bowl"), "bowl is full"),
        ((moved("orange", 2.4, 0.3),), ("PickMovable", "orange"), "orange is out of reach"),
        ((moved(JUICER, 2.4, 0.0),), ("CloseLid", JUICER), "juicer is out of reach"),
        ((machine(opened=False), lambda w: w.with_thing(replace(w.thing("juice_cup"), contents=("tea",), amount=0.8))),
         RUN, "juice_cup is full"),
    ],
)  # fmt: skip
def test_what_cannot_work_fails_with_its_cause(
    changes: tuple[Callable[[World], World], ...], skill: tuple[str, ...], why: str
) -> None:
    env = episode()
    for change in changes:
        env.world = change(env.world)
    before = env.world
    step = run(env, *skill)
    assert step.status is STUCK and why in step.detail
    assert env.world == before
