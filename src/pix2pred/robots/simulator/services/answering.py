"""What every answer has: a header with the request's, the robot's times, and a code."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any

from bosdyn.api import header_pb2, lease_pb2
from google.protobuf.duration_pb2 import Duration
from google.protobuf.timestamp_pb2 import Timestamp

from pix2pred.robots.simulator.leases import Ticket, Use
from pix2pred.robots.simulator.spot import SimulatedSpot

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


class Service:
    """A service of ``spot``."""

    def __init__(self, spot: SimulatedSpot) -> None:
        self.spot = spot


Filling = Callable[[Any, Any, Any], None]
"""A method of a service that is given the request and an empty answer, which it fills in."""
Call = Callable[[Any, Any, Any], Any]
"""A method of a service as the protocol has it: request and context in, answer out."""


def answers(message: Callable[[], Any]) -> Callable[[Filling], Call]:
    """Makes a call that answers with a ``message`` of the method that fills it in."""

    def made(fill: Filling) -> Call:
        @wraps(fill)
        def call(service: Service, request: Any, context: Any) -> Any:
            answer = message()
            with answering(service.spot, request, answer):
                fill(service, request, answer)
            return answer

        return call

    return made


def answers_in_turn(message: Callable[[], Any], *, moment: bool = False) -> Callable[[Filling], Call]:
    """The same of a method that runs in the robot's thread; at a ``moment``, planned faults strike."""

    def made(fill: Filling) -> Call:
        @answers(message)
        @wraps(fill)
        def call(service: Service, request: Any, answer: Any) -> None:
            service.spot.do(lambda: fill(service, request, answer), moment=moment)

        return call

    return made


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
