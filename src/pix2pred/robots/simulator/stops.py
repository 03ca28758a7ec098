"""Emergency stops by software: endpoints that check in; when one is silent, the robot settles and cuts its power."""

from __future__ import annotations

import uuid
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import IntEnum

_MASK = (1 << 64) - 1


class StopLevel(IntEnum):
    """What an endpoint asks for, with the numbers of the protocol: lower is more urgent."""

    CUT = 1
    SETTLE_THEN_CUT = 2
    NONE = 4


@dataclass(slots=True)
class Endpoint:
    """Somebody who can stop the robot, and who stops it by silence of more than ``timeout`` seconds."""

    name: str
    role: str
    timeout: float
    cut_after: float
    unique_id: str = field(default_factory=lambda: uuid.uuid4().hex)
    level: StopLevel = StopLevel.CUT
    heard: float = 0.0
    challenge: int = 0


class Stops:
    """The configuration of endpoints. Without any, the motors may not be switched on."""

    def __init__(self, now: Callable[[], float]) -> None:
        self._now = now
        self.config_id = uuid.uuid4().hex
        self.endpoints: dict[str, Endpoint] = {}
        self.pressed = False
        self._challenges = 0

    def configure(self, endpoints: Sequence[Endpoint]) -> None:
        """A new configuration. Its endpoints are to register; until they check in, the motors stay off."""
        self.config_id = uuid.uuid4().hex
        self.endpoints = {e.unique_id: e for e in endpoints}

    def register(self, endpoint: Endpoint) -> Endpoint:
        """Add an endpoint, in place of another one of the same role."""
        self.endpoints = {i: e for i, e in self.endpoints.items() if e.role != endpoint.role}
        endpoint.heard = self._now()
        self.endpoints[endpoint.unique_id] = endpoint
        return endpoint

    def next_challenge(self, endpoint: Endpoint) -> int:
        """A number that the endpoint must answer with its complement."""
        self._challenges += 1
        endpoint.challenge = (self._challenges * 0x9E3779B97F4A7C15) & _MASK
        return endpoint.challenge

    def answered(self, endpoint: Endpoint, challenge: int, response: int, level: StopLevel) -> bool:
        """A check-in; whether its answer is right, and it therefore counts."""
        if challenge != endpoint.challenge or response != (~challenge & _MASK):
            return False
        endpoint.heard, endpoint.level = self._now(), level
        return True

    @property
    def level(self) -> StopLevel:
        """What holds for the robot now: the most urgent that an endpoint asks for or that its silence means."""
        if self.pressed or not self.endpoints:
            return StopLevel.CUT
        return min(self.level_of(e) for e in self.endpoints.values())

    def level_of(self, endpoint: Endpoint) -> StopLevel:
        """What one endpoint asks for, or means by its silence."""
        silent = self._now() - endpoint.heard
        if silent > endpoint.timeout + endpoint.cut_after:
            return StopLevel.CUT
        if silent > endpoint.timeout:
            return min(endpoint.level, StopLevel.SETTLE_THEN_CUT)
        return endpoint.level

    def silent_for(self, endpoint: Endpoint) -> float:
        """Seconds since its last check-in that counted."""
        return self._now() - endpoint.heard
