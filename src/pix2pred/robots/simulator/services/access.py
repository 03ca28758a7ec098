"""Getting in: logging in, who the robot is, which services it has, and what time it is there."""

from __future__ import annotations

import hmac
import time
import uuid
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import grpc
import jwt
from bosdyn.api import (
    auth_pb2,
    auth_service_pb2_grpc,
    directory_pb2,
    directory_service_pb2_grpc,
    robot_id_pb2,
    robot_id_service_pb2_grpc,
    time_sync_pb2,
    time_sync_service_pb2_grpc,
)

from pix2pred.robots.simulator.services.answering import Service, answers, lasting, seconds_of, stamp
from pix2pred.robots.simulator.spot import SimulatedSpot

TOKEN_LASTS = 12 * 3600
"""Seconds, as on the robot."""

_OPEN = ("/bosdyn.api.AuthService/", "/bosdyn.api.RobotIdService/")
"""Services that answer without a token."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A service in the directory."""

    name: str
    type: str
    authority: str
    token: bool = True


class Door:
    """Knows the one user, and gives and checks tokens."""

    def __init__(self, user: str, password: str) -> None:
        self._user, self._password = user, password
        self._secret = uuid.uuid4().hex + uuid.uuid4().hex

    def token(self, user: str, password: str) -> str | None:
        """A token for the right name and password."""
        right = hmac.compare_digest(user.encode(), self._user.encode())
        if not (hmac.compare_digest(password.encode(), self._password.encode()) and right):
            return None
        now = int(time.time())
        made: str = jwt.encode({"sub": user, "iat": now, "exp": now + TOKEN_LASTS}, self._secret, algorithm="HS256")
        return made

    def renewed(self, token: str) -> str | None:
        """A new token for one that is still good."""
        return self.token(self._user, self._password) if self.opens(token) else None

    def opens(self, token: str) -> bool:
        """Whether a token is one of ours and not too old."""
        try:
            jwt.decode(token, self._secret, algorithms=["HS256"])
        except jwt.PyJWTError:
            return False
        return True


class Doorkeeper(grpc.ServerInterceptor):
    """Refuses calls without a good token."""

    def __init__(self, door: Door) -> None:
        self._door = door

    def intercept_service(self, continuation: Callable[[Any], Any], details: Any) -> Any:
        """The handler of a call, or one that refuses it."""
        if details.method.startswith(_OPEN):
            return continuation(details)
        for key, value in details.invocation_metadata:
            if key == "authorization" and self._door.opens(value.removeprefix("Bearer ")):
                return continuation(details)

        def refuse(_request: Any, context: Any) -> None:
            context.abort(grpc.StatusCode.UNAUTHENTICATED, "log in first: no valid token came with the call")

        return grpc.unary_unary_rpc_method_handler(refuse)


class Auth(Service, auth_service_pb2_grpc.AuthServiceServicer):
    """``auth``: a token for a name and a password."""

    def __init__(self, spot: SimulatedSpot, door: Door) -> None:
        super().__init__(spot)
        self._door = door

    @answers(auth_pb2.GetAuthTokenResponse)
    def GetAuthToken(self, request: Any, answer: Any) -> None:  # noqa: N802
        """A token, or STATUS_INVALID_LOGIN."""
        renewing = bool(request.token)
        token = self._door.renewed(request.token) if renewing else self._door.token(request.username, request.password)
        if token is None:
            answer.status = answer.STATUS_INVALID_TOKEN if renewing else answer.STATUS_INVALID_LOGIN
        else:
            answer.status, answer.token = answer.STATUS_OK, token


class RobotId(Service, robot_id_service_pb2_grpc.RobotIdServiceServicer):
    """``robot-id``: who this is."""

    @answers(robot_id_pb2.RobotIdResponse)
    def GetRobotId(self, request: Any, answer: Any) -> None:  # noqa: N802
        """Serial number, species and version."""
        who = answer.robot_id
        who.serial_number, who.species, who.version = self.spot.traits.serial, "spot", "simulated"
        who.nickname = "simulated spot"
        version = who.software_release.version
        version.major_version, version.minor_version, version.patch_level = 5, 2, 0


class Directory(Service, directory_service_pb2_grpc.DirectoryServiceServicer):
    """``directory``: the services there are."""

    def __init__(self, spot: SimulatedSpot, entries: Sequence[Entry]) -> None:
        super().__init__(spot)
        self._entries = {e.name: e for e in entries}

    @answers(directory_pb2.ListServiceEntriesResponse)
    def ListServiceEntries(self, request: Any, answer: Any) -> None:  # noqa: N802
        """All of them."""
        for entry in self._entries.values():
            self._fill(answer.service_entries.add(), entry)

    @answers(directory_pb2.GetServiceEntryResponse)
    def GetServiceEntry(self, request: Any, answer: Any) -> None:  # noqa: N802
        """One of them."""
        entry = self._entries.get(request.service_name)
        answer.status = answer.STATUS_OK if entry else answer.STATUS_NONEXISTENT_SERVICE
        if entry:
            self._fill(answer.service_entry, entry)

    def _fill(self, message: Any, entry: Entry) -> None:
        message.name, message.type, message.authority = entry.name, entry.type, entry.authority
        message.user_token_required = entry.token
        message.last_update.CopyFrom(stamp(self.spot.time()))


class TimeSync(Service, time_sync_service_pb2_grpc.TimeSyncServiceServicer):
    """``time-sync``: asks for a few round trips, then says how far the robot's clock is ahead."""

    def __init__(self, spot: SimulatedSpot) -> None:
        super().__init__(spot)
        self._trips: dict[str, list[tuple[float, float]]] = {}

    @answers(time_sync_pb2.TimeSyncUpdateResponse)
    def TimeSyncUpdate(self, request: Any, answer: Any) -> None:  # noqa: N802
        """The estimate so far: that of the quickest round trip."""
        clock = request.clock_identifier or uuid.uuid4().hex
        trips = self._trips.setdefault(clock, [])
        if request.HasField("previous_round_trip"):
            trips.append(_measured(request.previous_round_trip))
            del trips[:-25]
        answer.clock_identifier = clock
        state = answer.state
        enough = len(trips) >= self.spot.traits.samples
        state.status = state.STATUS_OK if enough else state.STATUS_MORE_SAMPLES_NEEDED
        if trips:
            for estimate, (trip, ahead) in (
                (answer.previous_estimate, trips[-1]),
                (state.best_estimate, min(trips)),
            ):
                estimate.round_trip_time.CopyFrom(lasting(trip))
                estimate.clock_skew.CopyFrom(lasting(ahead))
        state.measurement_time.CopyFrom(stamp(self.spot.time()))

    def knows(self, clock: str) -> bool:
        """Whether a clock is synchronised."""
        return len(self._trips.get(clock, ())) >= self.spot.traits.samples


def _measured(trip: Any) -> tuple[float, float]:
    """Round-trip time, and how far our clock is ahead of the client's."""
    sent, received = seconds_of(trip.client_tx), seconds_of(trip.server_rx)
    answered, heard = seconds_of(trip.server_tx), seconds_of(trip.client_rx)
    return (heard - sent) - (answered - received), ((received - sent) + (answered - heard)) / 2
