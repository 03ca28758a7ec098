"""What every answer has: a header with the request's, the robot's times, and a code."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from bosdyn.api import header_pb2, lease_pb2
from google.protobuf.duration_pb2 import Duration
from google.protobuf.timestamp_pb2 import Timestamp

from pix2pred.robots.simulator.leases import Ticket, Use
from pix2pred.robots.simulator.spot import SimulatedSpot

Answer = TypeVar("Answer")

NANO = 1_000_000_000


def stamp(seconds: float) -> Timestamp:
    """A time of the robot's clock."""
    return Timestamp(seconds=int(seconds), nanos=int((seconds - int(seconds)) * NANO))


def lasting(seconds: float) -> Duration:
    """A span of time."""
    whole = int(seconds // 1)
    return Duration(seconds=whole, nanos=int((seconds - whole) * NANO))


def seconds_of(message: Timestamp | Duration) -> float:
    """Seconds of a time or span."""
    return float(message.seconds) + float(message.nanos) / NANO


@contextmanager
def answering(spot: SimulatedSpot, request: Any, answer: Any) -> Iterator[None]:
    """Fill the header of ``answer``. What goes wrong within is told to the client as an internal error."""
    answer.header.request_header.CopyFrom(request.header)
    answer.header.request_received_timestamp.CopyFrom(stamp(spot.time()))
    answer.header.error.code = header_pb2.CommonError.CODE_OK
    try:
        yield
    except Exception as error:  # a robot answers, whatever happens in it
        answer.header.error.code = header_pb2.CommonError.CODE_INTERNAL_SERVER_ERROR
        answer.header.error.message = f"{type(error).__name__}: {error}"
    answer.header.response_timestamp.CopyFrom(stamp(spot.time()))


def ticket_of(lease: Any) -> Ticket | None:
    """A lease as it travels; None when none came."""
    if not lease.resource:
        return None
    return Ticket(lease.resource, lease.epoch, tuple(lease.sequence))


def lease_of(ticket: Ticket, owner: str) -> Any:
    """A lease as a message."""
    return lease_pb2.Lease(
        resource=ticket.resource, epoch=ticket.epoch, sequence=ticket.sequence, client_names=[owner] if owner else []
    )


def used(spot: SimulatedSpot, lease: Any, result: Any) -> bool:
    """Whether a command's lease is good; ``result`` tells the client. Call it in the robot's thread."""
    leases = spot.body.leases
    how = leases.use(ticket_of(lease))
    result.status = lease_pb2.LeaseUseResult.Status.Value(how.value)
    result.owner.client_name = leases.owner
    result.attempted_lease.CopyFrom(lease)
    result.latest_known_lease.CopyFrom(lease_of(leases.current, leases.owner))
    return how is Use.OK
