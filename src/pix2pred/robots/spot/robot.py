"""A Spot as a robot that runs skills: looks from home, and keeps in mind what it holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Self

import numpy as np

from pix2pred.robots.robot import CameraView, Outcome, RobotError, RobotMemory
from pix2pred.robots.spot.eyes import CameraShot, Eyes
from pix2pred.robots.spot.finding import Found, Outliner, points_of
from pix2pred.robots.spot.frames import ODOM, seen_from
from pix2pred.robots.spot.limbs import FailedError, Limbs
from pix2pred.robots.spot.session import SpotSession
from pix2pred.robots.spot.settings import CAMERAS, DEPTH_OF, FRONT, HOME, LOOKING, SHOULDER, SpotSettings
from pix2pred.robots.spot.skills.repertoire import Program, Repertoire
from pix2pred.robots.spot.whereabouts import Whereabouts
from pix2pred.structs import Action, Image, Object, Picture, State, Vocabulary, parse_application
from pix2pred.structs.environment import Step, StepStatus
from pix2pred.structs.space.poses import FloorPose, Pose

WAYS_HOME = 3
"""Times that the robot tries to get to where it looks from; people step aside in the meantime."""


@dataclass(frozen=True, slots=True)
class Hand:
    """What the robot can do, and the words for it."""

    programs: Repertoire
    words: Vocabulary


class Spot:
    """A Spot that knows the ``objects`` of a task, and what an earlier session left in ``memory``."""

    def __init__(
        self,
        name: str,
        session: SpotSession,
        outliner: Outliner,
        objects: Sequence[Object],
        hand: Hand,
        memory: RobotMemory = RobotMemory(),  # noqa: B008
    ) -> None:
        self.name, self.session = name, session
        self.objects = tuple(objects)
        self._outliner, self._memory, self._held = outliner, memory, memory.holding
        self._programs, self._words = hand.programs, hand.words
        self.eyes, self.limbs = Eyes(session), Limbs(session)
        self.whereabouts: Whereabouts
        self._moves = False

    @property
    def settings(self) -> SpotSettings:
        """How it is worked with."""
        return self.session.settings

    def __enter__(self) -> Self:
        try:
            self.session.open()
            self.session.check()
            self.whereabouts = Whereabouts(self.eyes, self.limbs, self.settings, self._memory.map_file)
            holds = self.session.state().manipulator_state.is_gripper_holding_item
            self._held = (self._held or self._taken()) if holds else None
        except BaseException:
            self.session.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._moves = False
        self.session.close()

    def start(self) -> None:
        if not self._moves:
            self.session.take()
            self._moves = True

    @property
    def holding(self) -> str | None:
        return self._held

    def _taken(self) -> str:
        """What the skill took that was under way when the last session ended. Raises ``RobotError``."""
        by_name = {o.name: o for o in self.objects}
        names = parse_application(self._memory.under_way).args if self._memory.under_way else ()
        for name in names:
            if name in by_name and by_name[name].type.name in self._programs.held:
                return name
        raise RobotError(
            Outcome.NOT_READY, "the hand holds something that no skill of the last session took: take it out of there"
        )

    def took(self, name: str) -> None:
        """The hand closed on an object. Raises ``FailedError`` when the robot feels nothing in it."""
        if not self.session.state().manipulator_state.is_gripper_holding_item:
            raise FailedError(f"nothing is in the hand, {name} was to be")
        self._held = name
        self.session.carry_freely()

    def released(self) -> None:
        """The hand is empty."""
        self._held = None

    def go_home(self) -> None:
        """To where the scene is seen best, the hand's camera looking down at it."""
        self.limbs.carry()
        self.whereabouts.go(HOME)
        floor = Pose.on_floor(self.whereabouts.map_from_odom.inverse * HOME)
        self.limbs.hand([floor * LOOKING], "odom")

    def views(self) -> Sequence[CameraView]:
        for left in reversed(range(WAYS_HOME)):
            try:
                self.go_home()
                break
            except FailedError as error:
                if not left:
                    raise RobotError(Outcome.BLOCKED, f"it does not get home: {error}; clear the way") from error
        shots = self.eyes.shots(CAMERAS)
        views = []
        for source in CAMERAS:
            shot = shots[source]
            outlines = self._outliner.find(shot, self.objects)
            picture = Picture(shot.name, Image.from_pixels(shot.upright()), dict(sorted(outlines.boxes.items())))
            views.append(CameraView(picture, self.map_from_body(shot) * shot.camera))
        return views

    def observe(self) -> State:
        pictures = tuple(view.picture for view in self.views())
        return State(pictures, {}, self._programs.told(self._words, self.objects, self._held))

    def execute(self, action: Action) -> Step:
        names = [o.name for o in action.objects]
        try:
            self._program(action.skill.name)(self, *names[1:])
        except FailedError as error:
            return Step(StepStatus.STUCK, f"{action} failed: {error}")
        return Step(StepStatus.DONE)

    def _program(self, skill: str) -> Program:
        if skill not in self._programs.programs:
            known = ", ".join(sorted(self._programs.programs))
            raise RobotError(Outcome.NOT_READY, f"no program for the skill {skill}; there are {known}")
        return self._programs.programs[skill]

    def map_from_body(self, shot: CameraShot) -> Pose:
        """The body seen from the map when a picture was taken."""
        return Pose.on_floor(self.whereabouts.map_from_odom) * shot.body

    def find(self, *names: str, others: Sequence[str] = ()) -> Mapping[str, Sequence[Found]]:
        """Where objects are, from the front cameras that see them, the one that sees most first.

        Raises ``FailedError`` when one of ``names`` is not seen; ``others`` may be hidden.
        """
        shots = self.eyes.shots([*FRONT, *(DEPTH_OF[s] for s in FRONT)])
        wanted = [o for o in self.objects if o.name in (*names, *others)]
        found: dict[str, list[Found]] = {n: [] for n in (*names, *others)}
        for source in FRONT:
            shot, depth = shots[source], shots[DEPTH_OF[source]]
            scale = depth.response.source.depth_scale or 1000.0
            for name, mask in self._outliner.find(shot, wanted).masks.items():
                seen = points_of(name, shot, depth.pixels, scale, mask, self.map_from_body(shot))
                if seen is not None:
                    found[name].append(seen)
        for name, seen_by in found.items():
            if not seen_by and name in names:
                raise FailedError(f"{name} is not seen")
            seen_by.sort(key=lambda f: -len(f.points))
        return found

    def hand_at(self) -> np.ndarray:
        """Where the hand is in the map."""
        tree = self.session.state().kinematic_state.transforms_snapshot
        return (Pose.on_floor(self.whereabouts.map_from_odom) * seen_from(tree, ODOM, "hand")).at

    def reaches(self, place: FloorPose, points: Sequence[np.ndarray]) -> bool:
        """Whether the hand gets to all points of the map from a place."""
        shoulder = Pose.on_floor(place).points(np.array(SHOULDER))
        return all(float(np.linalg.norm(p - shoulder)) <= self.settings.reach for p in points)

    def hand(self, path: Sequence[Pose], seconds: float = 0.0) -> None:
        """Move the hand through poses of the map."""
        odom = Pose.on_floor(self.whereabouts.map_from_odom.inverse)
        self.limbs.hand([odom * pose for pose in path], "odom", seconds)
