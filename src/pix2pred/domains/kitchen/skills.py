"""The two skills, executed by the physics (method 10.1): whatever is pushed badly really fails.

Every skill ends with the arm aside, so that the next picture shows what was done.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pix2pred.domains.kitchen.arm import HOME, Arm, UnreachableError, Vector
from pix2pred.domains.kitchen.classifiers import is_kettle_on, is_upright, knob_angle
from pix2pred.domains.kitchen.vocabulary import PUSH_KETTLE, TURN_ON_KNOB
from pix2pred.structs import Action

TURNED = -0.4
"""A knob is pushed until its angle is below this (radians), well past the point where it is on."""

CENTRED = 0.1
"""The kettle is pushed until its middle is within this of the burner's (metres, in x and y)."""

_PUSH = 0.005
"""Metres the gripper advances between two commands while it pushes."""

_LONGEST_TURN = 0.4
_LONGEST_PUSH = 0.6
_BEFORE_KNOB = (-0.1, -0.06, 0.05)
"""Where a push at a knob starts, relative to it: left of the pointer's upper end, in front of the panel."""

_KNOB_PITCH = 0.8
_KETTLE_PITCH = np.pi / 2
_ABOVE = 2.1
"""Height (metres) at which the gripper moves over everything on the stove."""

_BEFORE_PANEL = 0.42
_MIDDLE = (0.0, 0.42, _ABOVE)


class PushFailedError(RuntimeError):
    """A skill cannot reach its end; the message says why."""


def run_skill(action: Action, arm: Arm, data: Any) -> None:
    """Run a skill to its end. Raises ``SkillFailedError``, ``UnreachableError`` or ``DivergedError``."""
    _check(action)
    name, objects = action.skill.name, [o.name for o in action.objects]
    if name == TURN_ON_KNOB.name:
        _turn_on(arm, data, objects[1], action.params[0])
    else:
        _push_kettle(arm, data, objects[2], action.params)


def _check(action: Action) -> None:
    known = {s.name: s for s in (TURN_ON_KNOB, PUSH_KETTLE)}
    skill = known.get(action.skill.name)
    if skill is None:
        raise PushFailedError(f"the kitchen has no skill {action.skill.name}")
    if len(action.objects) != len(skill.types) or not all(
        o.type.is_a(t) for o, t in zip(action.objects, skill.types, strict=True)
    ):
        raise PushFailedError(f"{skill} does not take ({', '.join(o.name for o in action.objects)})")
    if len(action.params) != skill.dimension or not np.isfinite(action.params).all():
        raise PushFailedError(f"{skill.name} needs {skill.dimension} finite parameters, found {list(action.params)}")


def _turn_on(arm: Arm, data: Any, knob: str, angle: float) -> None:
    def turned() -> bool:
        return knob_angle(data, knob) < TURNED

    if turned():
        return
    start = data.site(f"{knob}_site").xpos + np.array(_BEFORE_KNOB)
    _approach(arm, _KNOB_PITCH, (start[0], _BEFORE_PANEL, start[2]), start)
    _push(arm, np.array([np.cos(angle), np.sin(angle), 0.0]), _LONGEST_TURN, turned)
    _go_home(arm)
    if not turned():
        raise PushFailedError(f"{knob} was turned to {knob_angle(data, knob):.2f} radians only")


def _push_kettle(arm: Arm, data: Any, burner: str, params: Sequence[float]) -> None:
    def there() -> bool:
        return is_kettle_on(data, burner, CENTRED)

    if there():
        return
    start = data.site("kettle_site").xpos + np.array(params[:3])
    _approach(arm, _KETTLE_PITCH, (start[0], start[1], _ABOVE), start)
    _push(arm, np.array([np.sin(params[3]), np.cos(params[3]), 0.0]), _LONGEST_PUSH, there)
    _go_home(arm)
    if not is_kettle_on(data, burner):
        state = "ended" if is_upright(data) else "was knocked over and ended"
        off = 100 * (data.body("kettle").xpos - data.body(f"Burner {burner[-1]}").xpos)
        raise PushFailedError(f"the kettle {state} {off[0]:+.0f} cm in x and {off[1]:+.0f} cm in y from {burner}")


def _approach(arm: Arm, pitch: float, via: ArrayLike, start: ArrayLike) -> None:
    """From home to where a push starts; back home when that cannot be reached."""
    arm.restart()
    arm.pitch = pitch
    try:
        arm.move(_MIDDLE, nearly=True)
        arm.move(via, nearly=True)
        arm.move(start)
    except UnreachableError:
        _go_home(arm)
        raise


def _push(arm: Arm, direction: Vector, longest: float, done: Callable[[], bool]) -> None:
    for _ in range(round(longest / _PUSH)):
        if done():
            break
        arm.command(arm.commanded + _PUSH * direction)


def _go_home(arm: Arm) -> None:
    """Back a little from what the gripper touches, up to where nothing is in the way, and aside."""
    arm.restart()
    x, y, z = arm.tip
    back = max(y - 0.1, 0.2)
    arm.move((x, back, z), nearly=True)
    arm.move((x, back, _ABOVE), nearly=True)
    arm.pitch = _KNOB_PITCH
    arm.move(_MIDDLE, nearly=True)
    arm.move(HOME, nearly=True)
