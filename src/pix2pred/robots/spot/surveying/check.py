"""What a person needs to know before a Spot moves. Nothing here moves it, and nothing takes it from anybody."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pix2pred.robots.localising.tags import TagFinder
from pix2pred.robots.robot import Outcome, RobotError
from pix2pred.robots.spot.eyes import Eyes
from pix2pred.robots.spot.link import named, trouble
from pix2pred.robots.spot.session import SpotSession
from pix2pred.robots.spot.settings import CAMERAS, DEPTH_OF
from pix2pred.robots.spot.whereabouts import sightings


@dataclass(frozen=True, slots=True)
class CheckedPart:
    """Something looked at, whether it stands in the way, and a sentence about it."""

    what: str
    fine: bool
    said: str

    def as_dict(self) -> dict[str, Any]:
        """The same for programs."""
        return {"what": self.what, "fine": self.fine, "said": self.said}


def check(session: SpotSession) -> list[CheckedPart]:
    """Look at everything that a task needs. ``session`` is open. Raises ``RobotError`` when the robot is silent."""
    found = [_who(session), *_state(session), _lease(session)]
    found += _cameras(session)
    return found


def _who(session: SpotSession) -> CheckedPart:
    with named("asking who it is"):
        who = session.client("robot-id").get_id(timeout=session.settings.deadlines.answer)
    version = who.software_release.version
    release = f"{version.major_version}.{version.minor_version}.{version.patch_level}"
    return CheckedPart(
        "robot", True, f"{who.nickname or who.species}, serial number {who.serial_number}, software {release}"
    )


def _state(session: SpotSession) -> list[CheckedPart]:
    state = session.state()
    charge = state.power_state.locomotion_charge_percentage.value
    skew = session.robot.time_sync.get_robot_clock_skew()
    found = [
        CheckedPart("clock", True, f"in step; the robot's is {skew.seconds + skew.nanos / 1e9:+.1f} s off"),
        CheckedPart("battery", charge >= 20, f"{charge:.0f} %"),
        CheckedPart(
            "arm", _has_arm(session), "there" if _has_arm(session) else "this Spot has no arm, and skills need one"
        ),
        CheckedPart("hand", True, "holds something" if state.manipulator_state.is_gripper_holding_item else "is empty"),
    ]
    pressed = [s.name for s in state.estop_states if s.type == s.TYPE_HARDWARE and s.state == s.STATE_ESTOPPED]
    found.append(
        CheckedPart("stop button", not pressed, f"{', '.join(pressed)} is pressed" if pressed else "not pressed")
    )
    wrong = trouble(state)
    if wrong is not None and wrong.outcome is not Outcome.ESTOPPED:
        found.append(CheckedPart("fitness", False, str(wrong)))
    return found


def _has_arm(session: SpotSession) -> bool:
    with named("asking for its arm"):
        return bool(session.robot.has_arm(timeout=session.settings.deadlines.answer))


def _lease(session: SpotSession) -> CheckedPart:
    with named("asking who has the robot"):
        resources = session.client("lease").list_leases(timeout=session.settings.deadlines.answer)
    owners = sorted({r.lease_owner.client_name for r in resources if r.lease_owner.client_name and not r.is_stale})
    return CheckedPart("lease", not owners, f"{', '.join(owners)} has it" if owners else "free")


def _cameras(session: SpotSession) -> list[CheckedPart]:
    with named("listing cameras"):
        there = {s.name for s in session.client("image").list_image_sources(timeout=session.settings.deadlines.answer)}
    missing = [c for c in (*CAMERAS, *DEPTH_OF.values()) if c not in there]
    found = [
        CheckedPart("cameras", not missing, f"{', '.join(missing)} missing" if missing else "all there, with distances")
    ]
    if missing:
        return found
    try:
        _, seen_tags = sightings(Eyes(session), TagFinder(session.settings.tag_size), session.settings)
    except RobotError as error:
        return [*found, CheckedPart("pictures", False, str(error))]
    tags = sorted({s.number for s in seen_tags})
    seen = f"sees {', '.join(map(str, tags))}" if tags else "sees none from here: it could not tell where it is"
    return [*found, CheckedPart("tags", bool(tags), seen)]
