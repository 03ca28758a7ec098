"""Who may move the robot and whether it may move at all: leases, emergency stops, motor power."""

from __future__ import annotations

from typing import Any

from bosdyn.api import (
    estop_pb2,
    estop_service_pb2_grpc,
    lease_pb2,
    lease_service_pb2_grpc,
    power_pb2,
    power_service_pb2_grpc,
)

from pix2pred.robots.simulator.leases import RESOURCES
from pix2pred.robots.simulator.services.answering import (
    Service,
    answers,
    answers_in_turn,
    lasting,
    lease_of,
    seconds_of,
    stamp,
    ticket_of,
    used,
)
from pix2pred.robots.simulator.spot import SimulatedSpot
from pix2pred.robots.simulator.stops import Endpoint, StopLevel


class LeaseService(Service, lease_service_pb2_grpc.LeaseServiceServicer):
    """``lease``: one lease for the whole body."""

    def __init__(self, spot: SimulatedSpot) -> None:
        super().__init__(spot)
        self._leases = spot.body.leases

    @answers_in_turn(lease_pb2.AcquireLeaseResponse)
    def AcquireLease(self, request: Any, answer: Any) -> None:  # noqa: N802
        """The lease, unless somebody has it."""
        if request.resource not in RESOURCES:
            answer.status = answer.STATUS_INVALID_RESOURCE
            return
        ticket = self._leases.acquire(request.header.client_name or "unknown")
        answer.status = answer.STATUS_OK if ticket else answer.STATUS_RESOURCE_ALREADY_CLAIMED
        answer.lease_owner.client_name = self._leases.owner
        if ticket:
            answer.lease.CopyFrom(lease_of(ticket, self._leases.owner))

    @answers_in_turn(lease_pb2.TakeLeaseResponse)
    def TakeLease(self, request: Any, answer: Any) -> None:  # noqa: N802
        """The lease, whoever has it; the robot stops."""
        if request.resource not in RESOURCES:
            answer.status = answer.STATUS_INVALID_RESOURCE
            return
        self.spot.body.halt()
        ticket = self._leases.take(request.header.client_name or "unknown")
        answer.status = answer.STATUS_OK
        answer.lease.CopyFrom(lease_of(ticket, self._leases.owner))
        answer.lease_owner.client_name = self._leases.owner

    @answers_in_turn(lease_pb2.ReturnLeaseResponse)
    def ReturnLease(self, request: Any, answer: Any) -> None:  # noqa: N802
        """Give the lease back; the robot stops."""
        ticket = ticket_of(request.lease)
        if ticket is None or not self._leases.give_back(ticket):
            answer.status = answer.STATUS_NOT_ACTIVE_LEASE
            return
        self.spot.body.halt()
        answer.status = answer.STATUS_OK

    @answers_in_turn(lease_pb2.RetainLeaseResponse)
    def RetainLease(self, request: Any, answer: Any) -> None:  # noqa: N802
        """The holder is still there."""
        used(self.spot, request.lease, answer.lease_use_result)

    @answers(lease_pb2.ListLeasesResponse)
    def ListLeases(self, request: Any, answer: Any) -> None:  # noqa: N802
        """Who has what."""
        resource = answer.resources.add(resource="body", is_stale=self._leases.stale)
        resource.lease.CopyFrom(lease_of(self._leases.current, self._leases.owner))
        resource.lease_owner.client_name = self._leases.owner
        resource.stale_time.CopyFrom(stamp(self.spot.time() + self._leases.stale_in))


class EstopService(Service, estop_service_pb2_grpc.EstopServiceServicer):
    """``estop``: endpoints that check in with answers to challenges."""

    def __init__(self, spot: SimulatedSpot) -> None:
        super().__init__(spot)
        self._stops = spot.body.stops

    @answers_in_turn(estop_pb2.RegisterEstopEndpointResponse)
    def RegisterEstopEndpoint(self, request: Any, answer: Any) -> None:  # noqa: N802
        """A new endpoint in the configuration named."""
        answer.request.CopyFrom(request)
        wanted = request.new_endpoint
        if request.target_config_id and request.target_config_id != self._stops.config_id:
            answer.status = answer.STATUS_CONFIG_MISMATCH
        elif not wanted.role or seconds_of(wanted.timeout) <= 0:
            answer.status = answer.STATUS_INVALID_ENDPOINT
        else:
            made = _read(wanted)
            self._stops.register(made)
            _fill(answer.new_endpoint, made)
            answer.status = answer.STATUS_SUCCESS

    @answers_in_turn(estop_pb2.DeregisterEstopEndpointResponse)
    def DeregisterEstopEndpoint(self, request: Any, answer: Any) -> None:  # noqa: N802
        """An endpoint goes; not while the motors are on."""
        answer.request.CopyFrom(request)
        known = self._find(request.target_endpoint)
        if self.spot.body.powered:
            answer.status = answer.STATUS_MOTORS_ON
        elif known is None:
            answer.status = answer.STATUS_ENDPOINT_MISMATCH
        else:
            self._stops.endpoints.pop(known.unique_id)
            answer.status = answer.STATUS_SUCCESS

    @answers_in_turn(estop_pb2.EstopCheckInResponse)
    def EstopCheckIn(self, request: Any, answer: Any) -> None:  # noqa: N802
        """An endpoint says what it wants, and that it is there."""
        answer.request.CopyFrom(request)
        known = self._find(request.endpoint)
        if known is None:
            answer.status = answer.STATUS_ENDPOINT_UNKNOWN
            return
        level = StopLevel(request.stop_level or StopLevel.CUT)
        right = self._stops.answered(known, request.challenge, request.response, level)
        answer.status = answer.STATUS_OK if right else answer.STATUS_INCORRECT_CHALLENGE_RESPONSE
        answer.challenge = self._stops.next_challenge(known)

    @answers(estop_pb2.GetEstopConfigResponse)
    def GetEstopConfig(self, request: Any, answer: Any) -> None:  # noqa: N802
        """The endpoints there are to be."""
        self._fill_config(answer.active_config)

    @answers_in_turn(estop_pb2.SetEstopConfigResponse)
    def SetEstopConfig(self, request: Any, answer: Any) -> None:  # noqa: N802
        """A new configuration; not while the motors are on."""
        answer.request.CopyFrom(request)
        if self.spot.body.powered:
            answer.status = answer.STATUS_MOTORS_ON
        elif request.target_config_id and request.target_config_id != self._stops.config_id:
            answer.status = answer.STATUS_INVALID_ID
        else:
            self._stops.configure([_read(e) for e in request.config.endpoints])
            answer.status = answer.STATUS_SUCCESS
        self._fill_config(answer.active_config)

    @answers(estop_pb2.GetEstopSystemStatusResponse)
    def GetEstopSystemStatus(self, request: Any, answer: Any) -> None:  # noqa: N802
        """What holds now, and who wants it."""
        answer.status.stop_level = int(self._stops.level)
        for endpoint in self._stops.endpoints.values():
            entry = answer.status.endpoints.add(stop_level=int(self._stops.level_of(endpoint)))
            _fill(entry.endpoint, endpoint)
            entry.time_since_valid_response.CopyFrom(lasting(self._stops.silent_for(endpoint)))

    def _find(self, endpoint: Any) -> Endpoint | None:
        return self._stops.endpoints.get(endpoint.unique_id)

    def _fill_config(self, config: Any) -> None:
        config.unique_id = self._stops.config_id
        for endpoint in self._stops.endpoints.values():
            _fill(config.endpoints.add(), endpoint)


CUT_AFTER = 4.0
"""Seconds between settling and cutting the power where a client names none."""


def _read(message: Any) -> Endpoint:
    cut = seconds_of(message.cut_power_timeout) or CUT_AFTER
    return Endpoint(message.name, message.role, seconds_of(message.timeout), cut)


def _fill(message: Any, endpoint: Endpoint) -> None:
    message.name, message.role, message.unique_id = endpoint.name, endpoint.role, endpoint.unique_id
    message.timeout.CopyFrom(lasting(endpoint.timeout))
    message.cut_power_timeout.CopyFrom(lasting(endpoint.cut_after))


class PowerService(Service, power_service_pb2_grpc.PowerServiceServicer):
    """``power``: the motors, on or off."""

    @answers_in_turn(power_pb2.PowerCommandResponse, moment=True)
    def PowerCommand(self, request: Any, answer: Any) -> None:  # noqa: N802
        """Switch the motors. Not on while stopped, fallen, or without charge."""
        body = self.spot.body
        if not used(self.spot, request.lease, answer.lease_use_result):
            return
        on = request.request in (request.REQUEST_ON, request.REQUEST_ON_MOTORS)
        if on and body.stops.level is not StopLevel.NONE:
            answer.status = power_pb2.STATUS_ESTOPPED
        elif on and body.fallen:
            answer.status = power_pb2.STATUS_FAULTED
        elif on and body.charge <= 0:
            answer.status = power_pb2.STATUS_BATTERY_MISSING
        elif on or request.request in (request.REQUEST_OFF, request.REQUEST_OFF_MOTORS):
            body.powered, body.standing = on, body.standing and on
            answer.status = power_pb2.STATUS_SUCCESS
        else:
            answer.status = power_pb2.STATUS_INTERNAL_ERROR
        answer.power_command_id = body.next_number()

    @answers(power_pb2.PowerCommandFeedbackResponse)
    def PowerCommandFeedback(self, request: Any, answer: Any) -> None:  # noqa: N802
        """Motors are switched at once."""
        answer.status = power_pb2.STATUS_SUCCESS
