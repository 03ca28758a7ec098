"""The body of a simulated Spot: where it is and believes to be, what it is doing, and what stops it."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence

import numpy as np

from pix2pred.robots.simulator.faults import FaultKind, Faults
from pix2pred.robots.simulator.leases import Leases
from pix2pred.robots.simulator.motion import End, Reach, reach
from pix2pred.robots.simulator.settings import (
    BODY_FROM_PLACE,
    CARRYING,
    READY,
    SHOULDER,
    STOWED,
    Traits,
)
from pix2pred.robots.simulator.stops import StopLevel, Stops
from pix2pred.robots.simulator.walking import Drift, Walk, drive, met, walk
from pix2pred.structs.space.poses import FloorPose, Pose
from pix2pred.structs.space.surroundings import Surroundings


class SimulatedBody:
    """State and motions. Everything here happens in one thread, after ``advance``."""

    def __init__(self, around: Surroundings, traits: Traits, faults: Faults, seed: int) -> None:
        self.around, self.traits, self.faults = around, traits, faults
        self.rng = np.random.default_rng(np.random.SeedSequence((seed, 31)))
        self.now = time.monotonic
        self.leases = Leases(self.now, traits.lease_patience)
        self.stops = Stops(self.now)
        self.place = around.start
        x, y, yaw = self.rng.uniform((-2, -2, -3), (2, 2, 3))
        self.felt = FloorPose(float(x), float(y), float(yaw))  # odometry starts anywhere
        self.hand, self.stowed = STOWED, True
        self.open = 0.0
        self.powered = self.standing = self.fallen = self.silent_cameras = False
        self.charge = 83.0
        self.stowable = self.docked = False
        self._walk: Walk | None = None
        self._reach: Reach | None = None
        self._numbers = 0
        self._put()

    @property
    def motion_time(self) -> float:
        """Seconds of motion since the start of the machine."""
        return self.now() * self.traits.pace

    @property
    def odom_from_room(self) -> Pose:
        """The room's frame seen from odometry's, as far as drift goes up to now; the robot does not know it."""
        return Pose.on_floor(self.felt) * Pose.on_floor(self.place).inverse

    @property
    def odom_from_body(self) -> Pose:
        """The body's frame seen from odometry's."""
        return Pose.on_floor(self.felt) * BODY_FROM_PLACE

    @property
    def moving(self) -> bool:
        """Whether the legs are on their way."""
        return self._walk is not None

    @property
    def reaching(self) -> bool:
        """Whether the hand is on its way."""
        return self._reach is not None

    @property
    def hand_in_room(self) -> Pose:
        """Where the hand is in truth."""
        return Pose.on_floor(self.place) * self.hand

    def next_number(self) -> int:
        """A number for a command."""
        self._numbers += 1
        return self._numbers

    def advance(self) -> None:
        """Move on to now; stop what may not go on."""
        if self.leases.stale or self.stops.level < StopLevel.NONE or not self.powered or self.fallen:
            self.halt()
            if self.powered and (self.leases.stale or self.stops.level is StopLevel.SETTLE_THEN_CUT):
                self.standing = False
            if self.stops.level is StopLevel.CUT:
                self.powered = self.standing = False
        self._walk_on()
        self._reach_on()

    def moment(self) -> None:
        """A command or picture was asked for: the faults that are due now strike."""
        for kind in self.faults.at_moment():
            if kind is FaultKind.LEASE_LOST:
                self.leases.lose()
                self.halt()
            elif kind is FaultKind.ESTOP:
                self.stops.pressed = True
            elif kind is FaultKind.FALL:
                self.fallen, self.standing, self.powered = True, False, False
            elif kind is FaultKind.BATTERY:
                self.charge, self.standing, self.powered = 0.0, False, False
            elif kind is FaultKind.CAMERA_TIMEOUT:
                self.silent_cameras = True
        self.advance()

    def halt(self) -> None:
        """Legs and hand stop where they are."""
        for motion in (self._walk, self._reach):
            if motion is not None and motion.end is End.RUNNING:
                motion.end = End.STOPPED
        self._walk = self._reach = None

    def go(self, *via: FloorPose, until: float = math.inf) -> Walk:
        """Walk until odometry says the last place of ``via``, which is where the nose shall be."""
        made = self._walk_through(via, until, self._drift())
        share = self.faults.share(FaultKind.BLOCKED)
        if share and self.rng.random() < share:
            made.clear = min(made.clear, float(self.rng.uniform()) * made.lasts)
        return self._begin(made)

    def go_in_room(self, via: Sequence[FloorPose], until: float) -> Walk:
        """Walk through places of the room that the robot sees, whatever its odometry says."""
        odom = self.odom_from_room
        felt = [(odom * Pose.on_floor(place)).floor for place in via]
        return self._begin(self._walk_through(felt, until, Drift()))

    def drive(self, velocity: FloorPose, seconds: float) -> Walk:
        """Walk with a velocity of the body for a while."""
        made = drive(
            self.felt, self.place, velocity, seconds, self.motion_time, self._drift(), self.traits.pace,
            self.around.stands,
        )  # fmt: skip
        return self._begin(made)

    def walkable(self, place: FloorPose) -> bool:
        """Whether the robot gets to a place of the room."""
        way = walk(self.place, self.place, (place,), 0.0, 0.0, Drift(), self.traits, self.around.stands)
        return met(way.true, self.around.stands) is None

    def _drift(self) -> Drift:
        return Drift.drawn(self.faults.share(FaultKind.DRIFT), self.rng)

    def _walk_through(self, via: Sequence[FloorPose], until: float, drift: Drift) -> Walk:
        now, stands = self.motion_time, self.around.stands
        return walk(self.felt, self.place, via, now, until, drift, self.traits, stands)

    def _begin(self, made: Walk) -> Walk:
        if self._walk is not None and self._walk.end is End.RUNNING:
            self._walk.end = End.STOPPED
        self._walk = made
        return made

    def lead(self, path: Sequence[Pose], times: Sequence[float]) -> Reach:
        """Move the hand through ``path``, whose poses are seen from the place under the nose."""
        if self._reach is not None and self._reach.end is End.RUNNING:
            self._reach.end = End.STOPPED
        self._reach = reach(self.hand, path, times, self.motion_time, self.traits)
        self.stowed = False
        return self._reach

    def grip(self, fraction: float) -> None:
        """Open or close the fingers. What is held falls when they open."""
        if fraction > 0.1 and self.around.holding is not None:
            self._put()
            self.around.let_go()
            self.stowable = False
        self.open = fraction

    def reachable(self, at: np.ndarray, place: FloorPose, margin: float = 0.0) -> bool:
        """Whether the hand of a robot that stands at ``place`` gets to a point of the room, and ``margin`` further."""
        shoulder = Pose.on_floor(place).points(np.array(SHOULDER))
        return float(np.linalg.norm(at - shoulder)) <= self.traits.reach - margin

    def _walk_on(self) -> None:
        going = self._walk
        if going is None:
            return
        now = self.motion_time
        self.felt, self.place = going.at(now)
        gone = now - going.began
        if gone >= going.clear:
            going.end = End.BLOCKED
        elif gone >= going.lasts:
            going.end = End.DONE
            going.then()
        elif self.now() >= going.until:
            going.end = End.STOPPED
        if going.end is not End.RUNNING:
            self._walk = None
        self._put()

    def _reach_on(self) -> None:
        going = self._reach
        if going is None:
            return
        base, due = Pose.on_floor(self.place), going.due(self.motion_time)
        while going.reached < due:  # one by one, so that what happens does not hang on how often we look
            pose = going.path[going.reached]
            if not self.reachable((base * pose).at, self.place) or not self.around.move_hand([base * pose]):
                going.end = End.BLOCKED
                break
            going.reached += 1
            self.hand = pose
        self._put()
        if going.end is End.RUNNING and going.reached == len(going.path):
            going.end = End.DONE
            self.stowed = self.hand is STOWED
        if going.end is not End.RUNNING:
            self._reach = None

    def _put(self) -> None:
        self.around.put_robot(self.place, self.hand_in_room)


NAMED = {1: CARRYING, 2: READY, 3: STOWED}
"""The arm's named positions by the numbers of the protocol."""


def facing_down(at: np.ndarray, place: FloorPose) -> Pose:
    """A hand over a point of the room that points at the floor, seen from ``place``."""
    in_room = Pose.looking(at.tolist(), place.yaw, math.pi / 2)
    return Pose.on_floor(place).inverse * in_room
