"""Things that go wrong on request, at a moment of one's choice, so that a program can be seen to end well."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from pix2pred.system.errors import Pix2predError


class FaultKind(StrEnum):
    """What can go wrong."""

    LEASE_LOST = "lease-lost"
    ESTOP = "estop"
    FALL = "fall"
    BATTERY = "battery-empty"
    CAMERA_TIMEOUT = "camera-timeout"
    GRASP_MISS = "grasp-miss"
    BLOCKED = "blocked"
    DRIFT = "drift"
    SLOW = "slow"


_SHARES = {FaultKind.GRASP_MISS, FaultKind.BLOCKED, FaultKind.DRIFT}
"""Kinds with a number: a probability, or a share of the way walked."""

FIRST_MOMENT = 20
"""Where a fault strikes that names no moment: after so many commands and pictures, a program is in the middle."""

_TEXT = re.compile(r"(?P<kind>[a-z-]+)(:(?P<share>[0-9.]+))?(@(?P<moment>[0-9]+))?")


class FaultError(Pix2predError, ValueError):
    """A fault that does not exist; the message lists those there are."""


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that goes wrong: with a probability or size ``share``, or once, at the ``moment``-th command."""

    kind: FaultKind
    share: float = 0.0
    moment: int = FIRST_MOMENT

    @classmethod
    def read(cls, text: str) -> Fault:
        """From ``lease-lost``, ``lease-lost@12``, ``grasp-miss:0.2``. Raises ``FaultError``."""
        found = _TEXT.fullmatch(text.strip())
        if found is None or found["kind"] not in list(FaultKind):
            raise FaultError(f"no fault {text!r}; choose from {', '.join(FaultKind)}, as in grasp-miss:0.2 or estop@12")
        kind = FaultKind(found["kind"])
        if (kind in _SHARES) != (found["share"] is not None):
            wanted = f"needs a number, as in {kind}:0.2" if kind in _SHARES else "takes no number"
            raise FaultError(f"fault {text!r}: {kind} {wanted}")
        share = float(found["share"] or 0)
        if not 0 <= share <= 1:
            raise FaultError(f"fault {text!r}: the number is a share between 0 and 1")
        return cls(kind, share, int(found["moment"] or FIRST_MOMENT))


@dataclass(slots=True)
class Faults:
    """The faults of a session. ``moments`` counts commands, grasps and pictures."""

    planned: Sequence[Fault] = ()
    moments: int = 0
    _struck: set[Fault] = field(default_factory=set)

    def share(self, kind: FaultKind) -> float:
        """The number of a fault, 0 when it was not asked for."""
        return max((f.share for f in self.planned if f.kind is kind), default=0.0)

    def has(self, kind: FaultKind) -> bool:
        """Whether a fault was asked for."""
        return any(f.kind is kind for f in self.planned)

    def at_moment(self) -> tuple[FaultKind, ...]:
        """Another command or picture was asked for: what goes wrong from now on."""
        self.moments += 1
        due = [f for f in self.planned if f.kind not in _SHARES and f.moment <= self.moments and f not in self._struck]
        self._struck.update(due)
        return tuple(f.kind for f in due)
