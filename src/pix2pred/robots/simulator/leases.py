"""Who may command the robot: leases that are acquired, used, retained, returned, and that grow stale."""

from __future__ import annotations

import uuid
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

RESOURCES = ("body", "mobility", "full-arm", "arm", "gripper")
"""What a lease is for; whoever has the body has all of it."""


class Use(StrEnum):
    """How a lease that came with a command compares with the one in force."""

    OK = "STATUS_OK"
    INVALID = "STATUS_INVALID_LEASE"
    OLDER = "STATUS_OLDER"
    REVOKED = "STATUS_REVOKED"
    UNMANAGED = "STATUS_UNMANAGED"
    WRONG_EPOCH = "STATUS_WRONG_EPOCH"


@dataclass(frozen=True, slots=True)
class Ticket:
    """A lease as it travels with a command.

    ``resource`` is what it is for; ``epoch`` changes when the robot starts; ``sequence`` grows with every use.
    """

    resource: str
    epoch: str
    sequence: tuple[int, ...]


class Leases:
    """The lease of the whole body. ``now`` gives seconds; it is stale when not retained for ``patience``."""

    def __init__(self, now: Callable[[], float], patience: float) -> None:
        self.epoch = uuid.uuid4().hex[:16]
        self.owner = ""
        self._now, self._patience = now, patience
        self._root = 0
        self._latest: tuple[int, ...] = ()
        self._retained = now()

    @property
    def held(self) -> bool:
        """Whether somebody has the lease."""
        return bool(self.owner)

    @property
    def stale(self) -> bool:
        """Whether its holder has not been heard of for too long."""
        return self.held and self._now() - self._retained > self._patience

    @property
    def stale_in(self) -> float:
        """Seconds until it is stale."""
        return max(0.0, self._patience - (self._now() - self._retained))

    @property
    def current(self) -> Ticket:
        """The latest lease known."""
        return Ticket("body", self.epoch, self._latest or (self._root,))

    def acquire(self, client: str) -> Ticket | None:
        """A lease for ``client``; None while another one is in force."""
        return None if self.held and not self.stale else self.take(client)

    def take(self, client: str) -> Ticket:
        """A lease for ``client``, whoever had it before."""
        self._root += 1
        self.owner, self._latest, self._retained = client, (self._root,), self._now()
        return self.current

    def give_back(self, ticket: Ticket) -> bool:
        """Return a lease; false when it is not the one in force."""
        if self.compare(ticket) is not Use.OK:
            return False
        self.owner = ""
        return True

    def lose(self) -> None:
        """Somebody else takes the robot away, as a person with a tablet does."""
        self.take("tablet")

    def compare(self, ticket: Ticket | None) -> Use:
        """How a lease compares with the one in force, which stays as it is."""
        if ticket is None or not ticket.sequence:
            return Use.INVALID
        if ticket.resource not in RESOURCES:
            return Use.UNMANAGED
        if ticket.epoch != self.epoch:
            return Use.WRONG_EPOCH
        if not self.held:
            return Use.REVOKED if ticket.sequence[0] <= self._root else Use.INVALID
        if ticket.sequence[0] < self._root or ticket.sequence < self._latest:
            return Use.OLDER
        if ticket.sequence[0] > self._root:
            return Use.INVALID
        return Use.REVOKED if self.stale else Use.OK

    def use(self, ticket: Ticket | None) -> Use:
        """A command came with ``ticket``. A good one becomes the latest; older ones are refused from then on."""
        result = self.compare(ticket)
        if result is Use.OK and ticket is not None:
            self._latest = max(self._latest, ticket.sequence)
            self._retained = self._now()
        return result
