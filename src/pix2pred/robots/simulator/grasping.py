"""Taking what is seen at a pixel: the robot walks there, reaches down, and closes its hand on what is there."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from pix2pred.robots.simulator.body import SimulatedBody, facing_down
from pix2pred.robots.simulator.faults import FaultKind
from pix2pred.robots.simulator.motion import End, Reach
from pix2pred.robots.simulator.settings import APPROACH
from pix2pred.robots.simulator.walking import Walk
from pix2pred.robots.standing import around
from pix2pred.structs.space.poses import Array, FloorPose, Pose
from pix2pred.structs.space.surroundings import Grip, Seen

MARGIN = 0.05
"""Metres by which a place must be nearer than the arm reaches: the walk ends a little beside it."""


class GraspState(IntEnum):
    """The states of the protocol that this robot goes through, with their numbers."""

    MOVING = 3
    SUCCEEDED = 6
    FAILED = 7
    NO_SOLUTION = 8
    NO_TARGET = 9
    WALKING = 10


@dataclass(slots=True)
class Grasp:
    """A grasp under way."""

    number: int
    target: Seen | None
    state: GraspState
    walk: Walk | None = None
    reach: Reach | None = None

    @property
    def over(self) -> bool:
        """Whether it has come to its end."""
        return self.state not in (GraspState.MOVING, GraspState.WALKING)


class Grasping:
    """The grasps that were commanded, carried on by ``advance``."""

    def __init__(self, body: SimulatedBody) -> None:
        self._body = body
        self.grasps: dict[int, Grasp] = {}
        self._current: Grasp | None = None

    def begin(self, origin: Array, direction: Array, *, may_walk: bool) -> Grasp:
        """Take what a ray, seen from odometry's frame, meets first."""
        body = self._body
        room = body.odom_from_room.inverse
        seen = body.around.seen(room.points(origin), room.axes @ direction)
        grasp = Grasp(body.next_number(), seen, GraspState.MOVING)
        self.grasps[grasp.number] = grasp
        if seen is None:
            grasp.state = GraspState.NO_TARGET
            return grasp
        self._current = grasp
        if self._within(seen.at, body.place, 0.0):
            self._reach_down(grasp)
        elif (place := self._place_for(seen.at)) is not None and may_walk:
            felt = (body.odom_from_room * Pose.on_floor(place)).floor
            grasp.walk, grasp.state = body.go(felt), GraspState.WALKING
        else:
            grasp.state = GraspState.NO_SOLUTION
        return grasp

    def advance(self) -> None:
        """Carry on with the grasp under way."""
        grasp, body = self._current, self._body
        if grasp is None or grasp.over:
            return
        if grasp.state is GraspState.WALKING and grasp.walk is not None and grasp.walk.end is not End.RUNNING:
            if grasp.walk.end is End.DONE:
                self._reach_down(grasp)
            else:
                grasp.state = GraspState.FAILED
        elif grasp.reach is not None and grasp.reach.end is not End.RUNNING:
            if grasp.reach.end is End.DONE:
                grasp.state = GraspState.SUCCEEDED if self._closes(grasp) else GraspState.FAILED
            else:
                grasp.state = GraspState.FAILED
        elif not body.powered or not body.standing:
            grasp.state = GraspState.FAILED

    def _reach_down(self, grasp: Grasp) -> None:
        body, target = self._body, grasp.target
        assert target is not None, "there is a target to reach for"
        above = facing_down(target.at + np.array([0, 0, APPROACH]), body.place)
        down = facing_down(target.at, body.place)
        body.grip(1.0)
        grasp.reach, grasp.state = body.lead([above, down], [0.0, 0.0]), GraspState.MOVING

    def _closes(self, grasp: Grasp) -> bool:
        body, target = self._body, grasp.target
        body.grip(0.0)
        miss = body.faults.share(FaultKind.GRASP_MISS)
        if target is None or target.name is None or (miss and body.rng.random() < miss):
            return False
        return body.around.grasp(target.name) is Grip.TAKEN

    def _place_for(self, at: Array) -> FloorPose | None:
        """The nearest place from which the arm reaches a point of the room, and to which the robot gets."""
        body = self._body
        for place in around(at, body.place):
            if self._within(at, place, MARGIN) and body.walkable(place):
                return place
        return None

    def _within(self, at: Array, place: FloorPose, margin: float) -> bool:
        """Whether the hand gets to a point and over it."""
        above = at + np.array([0, 0, APPROACH])
        return all(self._body.reachable(p, place, margin) for p in (at, above))
