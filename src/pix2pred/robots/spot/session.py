"""A session with a Spot: connected, clocks in step, stop button and lease in hand; a way out that leaves it safe."""

from __future__ import annotations

import contextlib
import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import bosdyn.client
from bosdyn.api import manipulation_api_pb2, robot_state_pb2
from bosdyn.client.estop import EstopClient, EstopEndpoint, EstopKeepAlive
from bosdyn.client.lease import LeaseClient, LeaseKeepAlive
from bosdyn.client.power import power_off_motors, power_on_motors
from bosdyn.client.robot_command import RobotCommandBuilder, RobotCommandClient, blocking_sit, blocking_stand

from pix2pred.robots.robot import Outcome, RobotError
from pix2pred.robots.spot.credentials import Credentials
from pix2pred.robots.spot.interrupts import heard_later
from pix2pred.robots.spot.link import named, trouble
from pix2pred.robots.spot.settings import SpotSettings

CLIENT = "pix2pred-spot"
"""How we call ourselves to the robot; the client's loggers are called so too."""

QUICK = 20.0
"""Hertz at which the client asks whether standing or power is there yet."""


@dataclass(frozen=True, slots=True)
class Address:
    """Where a robot answers. ``port`` and ``certificate`` are those of a simulated one; None for a real one."""

    host: str
    port: int | None = None
    certificate: str | None = None


class SpotSession:
    """Clients of one robot. ``open`` moves nothing; ``take`` takes the lease and stands up; ``close`` undoes both."""

    def __init__(self, address: Address, who: Credentials, settings: SpotSettings) -> None:
        self.settings = settings
        self._address, self._who = address, who
        self.robot: Any = None
        self._keeps: list[tuple[str, Callable[[], Any]]] = []
        self._lease: LeaseKeepAlive | None = None

    @property
    def where(self) -> str:
        """The robot's name or address."""
        return self._address.host

    def open(self) -> None:
        """Log in and bring the clocks in step. Raises ``RobotError``."""
        for name in (CLIENT, "bosdyn"):  # the client logs whole requests, the one with the password too
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
        deadlines = self.settings.deadlines
        where = self._address.host
        with named(f"connecting to {where}"):
            try:
                sdk = bosdyn.client.create_standard_sdk(CLIENT, cert_resource_glob=self._address.certificate)
            except OSError as error:
                raise RobotError(Outcome.NOT_READY, f"certificate {self._address.certificate}: {error}") from error
            self.robot = sdk.create_robot(where)
            if self._address.port is not None:
                self.robot.update_secure_channel_port(self._address.port)
            try:
                self.robot.authenticate(self._who.user, self._who.password, timeout=deadlines.login)
            except bosdyn.client.auth.InvalidLoginError as error:
                raise RobotError(Outcome.NOT_READY, f"{where} does not know this user and password") from error
            try:
                self.robot.time_sync.wait_for_sync(timeout_sec=deadlines.time_sync)
            except bosdyn.client.time_sync.TimeSyncError as error:
                raise RobotError(Outcome.CONNECTION_LOST, f"{where}: the clocks did not get in step") from error
        self._keeps.append(("clocks", self.robot.stop_time_sync))

    def client(self, service: str) -> Any:
        """A client of a service. Raises ``RobotError`` when the robot has no such service."""
        with named(f"service {service}"):
            try:
                return self.robot.ensure_client(service)
            except bosdyn.client.robot.UnregisteredServiceNameError as error:
                raise RobotError(Outcome.NOT_READY, f"the robot has no service {service!r}") from error

    def state(self) -> Any:
        """What the robot says of itself. Raises ``RobotError``."""
        with named("asking for the robot's state"):
            return self.client("robot-state").get_robot_state(timeout=self.settings.deadlines.answer)

    def check(self) -> None:
        """Raise ``RobotError`` when the robot says that it cannot go on, or when somebody else has it."""
        found = trouble(self.state())
        ours_to_release = self._lease is None and found is not None and found.outcome is Outcome.ESTOPPED
        if found is not None and not ours_to_release:  # it is stopped until a program's stop button is there
            raise found
        if self._lease is not None and not self._lease.is_alive():
            raise RobotError(Outcome.LEASE_LOST, "the lease is not kept any more: somebody else has the robot")

    def owns(self) -> bool:
        """Whether the robot still takes our lease."""
        try:
            with named("keeping the lease"):
                client = self.client(LeaseClient.default_service_name)
                client.retain_lease(client.lease_wallet.get_lease(), timeout=self.settings.deadlines.answer)
        except RobotError as error:
            return error.outcome is not Outcome.LEASE_LOST
        return True

    def why(self) -> RobotError | None:
        """What is wrong with the robot, as far as it answers."""
        try:
            return trouble(self.state())
        except RobotError:
            return None

    def take(self) -> None:
        """Lease, stop button, power, and standing up. Raises ``RobotError``.

        Nobody may change the stop buttons of a robot whose motors are on: one that somebody left so sits down first.
        """
        deadlines = self.settings.deadlines
        with named("acquiring the lease", self.why):
            self._lease = LeaseKeepAlive(
                self.client(LeaseClient.default_service_name), must_acquire=True, warnings=False
            )
        with named("switching off the motors that were left on", self.why):
            self._sit()
        with named("setting up the stop button", self.why):
            endpoint = EstopEndpoint(
                self.client(EstopClient.default_service_name), "pix2pred", self.settings.estop_timeout
            )
            endpoint.force_simple_setup()
            keep = EstopKeepAlive(endpoint)
            self._keeps.append(("stop button", keep.shutdown))
        self.check()
        with named("powering on", self.why):
            power_on_motors(self.client("power"), deadlines.power, QUICK, timeout=deadlines.answer)
        with named("standing up", self.why):
            blocking_stand(self.client(RobotCommandClient.default_service_name), deadlines.stand, QUICK)

    def command(self, command: Any, lasts: float | None = None) -> int:
        """Send a command, which ends after ``lasts`` seconds at the latest; gives its number. Raises ``RobotError``."""
        with named("commanding", self.why):
            client = self.client(RobotCommandClient.default_service_name)
            until = time.time() + lasts if lasts is not None else None
            return int(client.robot_command(command, end_time_secs=until, timeout=self.settings.deadlines.answer))

    def feedback(self, number: int) -> Any:
        """How a command is getting on. Raises ``RobotError``."""
        with named("asking how it goes", self.why):
            client = self.client(RobotCommandClient.default_service_name)
            return client.robot_command_feedback(number, timeout=self.settings.deadlines.answer).feedback

    def carry_freely(self) -> None:
        """Tell the robot that what it holds may be carried and stowed."""
        wanted = robot_state_pb2.ManipulatorState.CARRY_STATE_CARRIABLE_AND_STOWABLE
        override = manipulation_api_pb2.ApiGraspedCarryStateOverride(override_request=wanted)
        request = manipulation_api_pb2.ApiGraspOverrideRequest(carry_state_override=override)
        with named("carrying", self.why):
            self.client("manipulation").grasp_override_command(request, timeout=self.settings.deadlines.answer)

    def close(self) -> None:
        """Stop, put the arm away, sit, power off, return the lease: as much of it as the robot still lets us do.

        Ctrl-C is heard when this is done.
        """
        if self.robot is not None:
            with heard_later():
                self._leave()

    def _leave(self) -> None:
        if self._lease is not None:
            for step in (self._halt, self._stow, self._sit, self._give_back):
                with contextlib.suppress(Exception):  # every one of them may fail, and the next must be tried
                    step()
            self._lease = None
        for _, end in reversed(self._keeps):
            with contextlib.suppress(Exception):
                end()
        self._keeps.clear()
        with contextlib.suppress(Exception):
            self.robot.shutdown()
        self.robot = None

    def _halt(self) -> None:
        self.command(RobotCommandBuilder.stop_command())

    def _stow(self) -> None:
        if not self.robot.is_powered_on(timeout=self.settings.deadlines.answer):
            return
        self.carry_freely()
        number = self.command(RobotCommandBuilder.arm_stow_command())
        until = time.monotonic() + self.settings.deadlines.leaving
        while time.monotonic() < until:
            arm = self.feedback(number).synchronized_feedback.arm_command_feedback.named_arm_position_feedback
            if arm.status in (arm.STATUS_COMPLETE, arm.STATUS_STALLED_HOLDING_ITEM):
                return
            time.sleep(self.settings.poll)

    def _sit(self) -> None:
        if not self.robot.is_powered_on(timeout=self.settings.deadlines.answer):
            return
        leaving = self.settings.deadlines.leaving
        blocking_sit(self.client(RobotCommandClient.default_service_name), leaving, QUICK)
        power_off_motors(self.client("power"), leaving, QUICK, timeout=self.settings.deadlines.answer)

    def _give_back(self) -> None:
        assert self._lease is not None, "there is a lease to give back"
        keep, client = self._lease, self.client(LeaseClient.default_service_name)
        lease = client.lease_wallet.get_lease()
        keep.shutdown()
        client.return_lease(lease, timeout=self.settings.deadlines.answer)
