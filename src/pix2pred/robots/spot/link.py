"""Calls to the robot: each has a deadline, and each way in which one can fail ends in an outcome with a name."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from bosdyn.api import robot_state_pb2
from bosdyn.client.exceptions import (
    Error,
    LeaseUseError,
    RpcError,
    TimedOutError,
    UnauthenticatedError,
)
from bosdyn.client.lease import Error as LeaseError
from bosdyn.client.lease import LeaseResponseError

from pix2pred.robots.robot import Outcome, RobotError
from pix2pred.robots.spot.interrupts import heard_later


@contextmanager
def named(doing: str, why: Callable[[], RobotError | None] = lambda: None) -> Iterator[None]:
    """Turn the client's errors into ``RobotError``. ``why`` asks the robot what is wrong, when it refused.

    Ctrl-C is heard at the end.
    """
    try:
        with heard_later():
            yield
    except (LeaseUseError, LeaseResponseError, LeaseError) as error:
        raise RobotError(
            Outcome.LEASE_LOST,
            f"{doing}: somebody else has the robot ({type(error).__name__}); give it back and try again",
        ) from error
    except UnauthenticatedError as error:
        raise RobotError(Outcome.NOT_READY, f"{doing}: the robot wants a new login") from error
    except TimedOutError as error:
        raise RobotError(Outcome.CONNECTION_LOST, f"{doing}: no answer in time") from error
    except RpcError as error:
        raise RobotError(Outcome.CONNECTION_LOST, f"{doing}: no connection ({type(error).__name__})") from error
    except Error as error:  # refused, failed, or not done in time
        raise (why() or RobotError(Outcome.NOT_READY, f"{doing}: {type(error).__name__}: {error}")) from error


def trouble(state: Any) -> RobotError | None:
    """What in the robot's state keeps it from going on; None when nothing does."""
    kinds = robot_state_pb2
    for fault in state.behavior_fault_state.faults:
        if fault.cause == kinds.BehaviorFault.CAUSE_FALL:
            return RobotError(Outcome.FALLEN, "the robot has fallen: help it up by hand or tablet, then start again")
    battery = state.power_state.locomotion_charge_percentage
    if state.power_state.HasField("locomotion_charge_percentage") and battery.value < LEAST_CHARGE:
        return RobotError(Outcome.BATTERY_EMPTY, f"the battery is at {battery.value:.0f} %: charge or change it")
    for stop in state.estop_states:
        if stop.state == kinds.EStopState.STATE_ESTOPPED:
            return RobotError(
                Outcome.ESTOPPED, f"stopped by {stop.name or 'an emergency stop'}: release it, start again"
            )
    return None


LEAST_CHARGE = 5.0
"""Percent below which nothing is begun or gone on with; the robot sits down by itself a little later."""
