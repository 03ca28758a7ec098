"""A simulated Spot: a body in its surroundings, for whom one thread does everything."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from pix2pred.robots.simulator.body import SimulatedBody
from pix2pred.robots.simulator.faults import Fault, FaultKind, Faults
from pix2pred.robots.simulator.grasping import Grasping
from pix2pred.robots.simulator.settings import Traits
from pix2pred.structs.space.surroundings import Surroundings

T = TypeVar("T")

TICK = 0.05
"""Seconds between two looks at time-outs when nobody asks anything."""

SLOWNESS = 0.25
"""Seconds that a slow robot takes longer for every answer."""


class SimulatedSpot:
    """What the services of a robot are about. ``make`` builds its surroundings in the thread that will use them."""

    def __init__(self, make: Callable[[], Surroundings], traits: Traits, faults: Sequence[Fault], seed: int) -> None:
        self.traits = traits
        self.faults = Faults(tuple(faults))
        self._thread = ThreadPoolExecutor(1, "world")
        self._ending = threading.Event()

        def build() -> tuple[SimulatedBody, Grasping]:
            body = SimulatedBody(make(), traits, self.faults, seed)
            return body, Grasping(body)

        self.body, self.grasping = self._thread.submit(build).result()
        self._ticker = threading.Thread(target=self._tick, name="ticker", daemon=True)
        self._ticker.start()

    def do(self, work: Callable[[], T], *, moment: bool = False) -> T:
        """Run ``work`` in the robot's thread, after everything moved on; a ``moment`` lets planned faults strike."""

        def run() -> T:
            if moment:
                self.body.moment()
            self.body.advance()
            self.grasping.advance()
            return work()

        if self.faults.has(FaultKind.SLOW):
            time.sleep(SLOWNESS)
        return self._thread.submit(run).result()

    def time(self) -> float:
        """The robot's clock, seconds since 1970."""
        return time.time() + self.traits.clock_ahead

    def close(self) -> None:
        """Stop, and free what drawing needs."""
        self._ending.set()
        self._ticker.join()
        self._thread.submit(self.body.around.close).result()
        self._thread.shutdown()

    def _tick(self) -> None:
        while not self._ending.wait(TICK):
            self._thread.submit(self._move_on).result()

    def _move_on(self) -> None:
        self.body.advance()
        self.grasping.advance()
