"""Name and password of the robot: from the environment, or typed. They are kept in memory alone and shown nowhere."""

from __future__ import annotations

import getpass
import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field

from pix2pred.robots.robot import Outcome, RobotError

USER, PASSWORD = "BOSDYN_CLIENT_USERNAME", "BOSDYN_CLIENT_PASSWORD"
"""The variables that the vendor's programs read too."""


@dataclass(frozen=True, slots=True)
class Credentials:
    """``repr`` and error messages do not show the password."""

    user: str
    password: str = field(repr=False)


def credentials(environment: Mapping[str, str] | None = None) -> Credentials:
    """Those of the environment, or those a person at the terminal types.

    Raises ``RobotError`` when neither is there.
    """
    found = os.environ if environment is None else environment
    if found.get(USER) and found.get(PASSWORD):
        return Credentials(found[USER], found[PASSWORD])
    if not sys.stdin.isatty():
        raise RobotError(
            Outcome.NOT_READY, f"set {USER} and {PASSWORD} in the environment; without a terminal nobody can be asked"
        )
    user = found.get(USER) or input("user of the robot: ")
    return Credentials(user, found.get(PASSWORD) or getpass.getpass("password of the robot: "))
