"""Walking: legs one after another that take time, that drift, and that end where something stands in the way."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pix2pred.robots.simulator.motion import End
from pix2pred.robots.simulator.settings import BODY_FROM_PLACE, Traits
from pix2pred.structs.space.poses import FloorPose, wrapped

Rng = np.random.Generator
Stands = Callable[[FloorPose], bool]
"""Whether a robot can stand at a place."""

TURN_PER_METRE = 0.4
"""Radians that the heading is off after a metre, as a multiple of the drift's share."""

BACK = (0.0, 0.3, 0.6, 0.9)
"""Metres that a robot steps back from where it stands, and that it stops before its goal, to get around things."""

STEP, TURN = 0.05, 0.1
"""Metres and radians between two places of a way at which it is looked whether something stands there."""

SLICE = 0.1
"""Seconds of a velocity command that are walked as one leg."""

_MIDDLE = BODY_FROM_PLACE.floor
"""The middle of the body, about which the robot turns, seen from the place under its nose."""


def between(a: FloorPose, b: FloorPose, share: float) -> FloorPose:
    """The place after ``share`` of the way: the middle of the body goes straight, turning the shorter way."""
    a, b = a * _MIDDLE, b * _MIDDLE
    turn = wrapped(b.yaw - a.yaw)
    at = FloorPose(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), wrapped(a.yaw + share * turn))
    return at * _MIDDLE.inverse


@dataclass(frozen=True, slots=True)
class Drift:
    """How odometry errs on one walk: shares of the way and of the turn, and radians of heading per metre."""

    longer: float = 0.0
    turned: float = 0.0
    off: float = 0.0

    @classmethod
    def drawn(cls, share: float, rng: Rng) -> Drift:
        """Errors of up to ``share``."""
        longer, turned, off = (float(v) for v in rng.uniform(-share, share, size=3))
        return cls(longer, turned, off * TURN_PER_METRE)

    def real(self, step: FloorPose) -> FloorPose:
        """The step that was made in truth when odometry says ``step``."""
        heading = self.off * math.hypot(step.x, step.y)
        c, s = math.cos(heading / 2), math.sin(heading / 2)
        stretch = 1 + self.longer
        x, y = stretch * (c * step.x - s * step.y), stretch * (s * step.x + c * step.y)
        return FloorPose(x, y, wrapped(step.yaw) * (1 + self.turned) + heading)


@dataclass(slots=True)
class Walk:
    """Places one after another, as odometry has them and as they are in truth, each reached ``after`` a time.

    ``clear`` is the time after which something stands in the way; ``then`` is done on arrival.
    """

    felt: Sequence[FloorPose]
    true: Sequence[FloorPose]
    after: Sequence[float]
    began: float
    until: float
    clear: float = math.inf
    end: End = End.RUNNING
    then: Callable[[], None] = lambda: None

    @property
    def lasts(self) -> float:
        """Seconds of motion until the goal."""
        return self.after[-1]

    def at(self, now: float) -> tuple[FloorPose, FloorPose]:
        """Where odometry has it and where it is now."""
        gone = min(max(0.0, now - self.began), self.clear, self.lasts)
        leg = next(k for k in range(1, len(self.after)) if gone <= self.after[k])
        share = (gone - self.after[leg - 1]) / (self.after[leg] - self.after[leg - 1])
        felt, true = self.felt, self.true
        return between(felt[leg - 1], felt[leg], share), between(true[leg - 1], true[leg], share)


def walk(
    felt: FloorPose, true: FloorPose, via: Sequence[FloorPose], now: float, until: float, drift: Drift, traits: Traits,
    stands: Stands,
) -> Walk:  # fmt: skip
    """A walk through the places ``via`` of odometry's frame.

    It steps back and around where something stands on the straight way; where that does not help either, it goes
    straight until it meets it. In truth the robot ends where ``drift`` brings it.
    """
    real = [true * drift.real(felt.inverse * goal) for goal in via]
    legs = next((w for w in _ways(true, real) if met(w, stands) is None), (true, *real))
    seen = [_undrifted(place, true, felt, drift) for place in legs[:-1]]
    after = [0.0]
    for a, b in itertools.pairwise(legs):
        way, turn = a.distance(b), a.turn_to(b)
        after.append(after[-1] + max(0.2, way / traits.walking_speed + turn / traits.turning_speed))
    made = Walk((*seen, via[-1]), legs, after, now, until)
    return _stopped(made, stands)


def drive(
    felt: FloorPose, true: FloorPose, velocity: FloorPose, seconds: float, now: float, drift: Drift, pace: float,
    stands: Stands,
) -> Walk:  # fmt: skip
    """The body walks with a ``velocity`` (metres and radians a second, as it sees it) until something stands there.

    A velocity means what it says at any ``pace``: it is not hurried.
    """
    places, count = [felt], max(1, math.ceil(seconds / SLICE))
    for _ in range(count):
        share = seconds / count
        turn = velocity.yaw * share
        c, s = math.cos(turn / 2), math.sin(turn / 2)
        x, y = (velocity.x * c - velocity.y * s) * share, (velocity.x * s + velocity.y * c) * share
        places.append(places[-1] * _MIDDLE * FloorPose(x, y, turn) * _MIDDLE.inverse)
    real = [true * drift.real(felt.inverse * place) for place in places]
    after = [k * seconds * pace / count for k in range(count + 1)]
    return _stopped(Walk(places, real, after, now, math.inf), stands)


def met(legs: Sequence[FloorPose], stands: Stands) -> tuple[int, float] | None:
    """On which leg, and after which share of it, something stands in the way; None for a clear way.

    What touches the robot where it starts does not keep it from leaving, unless it stands at the goal too.
    """
    leaving = not stands(legs[0])
    if leaving and not stands(legs[-1]):
        return 1, 0.0
    for leg, (a, b) in enumerate(itertools.pairwise(legs), start=1):
        steps = max(1, math.ceil(max(a.distance(b) / STEP, a.turn_to(b) / TURN)))
        for k in range(1, steps + 1):
            free = stands(between(a, b, k / steps))
            if not free and not leaving:
                return leg, (k - 1) / steps
            leaving = leaving and not free
    return None


def _stopped(made: Walk, stands: Stands) -> Walk:
    found = met(made.true, stands)
    if found is not None:
        leg, share = found
        made.clear = made.after[leg - 1] + share * (made.after[leg] - made.after[leg - 1])
    return made


def _ways(start: FloorPose, via: Sequence[FloorPose]) -> Iterator[tuple[FloorPose, ...]]:
    """Ways to try: straight, then stepping back and stopping before the goal, the shorter ones first."""
    for back, before in sorted(itertools.product(BACK, BACK), key=sum):
        away = (start * FloorPose(-back),) if back else ()
        approach = (via[0] * FloorPose(-before),) if before else ()
        yield (start, *away, *approach, *via)


def _undrifted(place: FloorPose, true: FloorPose, felt: FloorPose, drift: Drift) -> FloorPose:
    """Where odometry has a place, but for second orders of the drift."""
    step = true.inverse * place
    back = Drift(-drift.longer, -drift.turned, -drift.off)
    return felt * back.real(step)
