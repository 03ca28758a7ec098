"""Putting a Spot together: connection, credentials, outlines, programs; looking at one; mapping the tags around one."""

from __future__ import annotations

from pathlib import Path

from pix2pred.robots.addresses import SpotAt
from pix2pred.robots.robot import RobotMemory
from pix2pred.robots.spot.credentials import credentials
from pix2pred.robots.spot.finding import Outliner
from pix2pred.robots.spot.robot import Hand, Spot
from pix2pred.robots.spot.session import Address, SpotSession
from pix2pred.robots.spot.settings import SpotSettings
from pix2pred.robots.spot.skills.repertoire import Repertoire
from pix2pred.robots.spot.surveying.check import CheckedPart, check
from pix2pred.robots.spot.surveying.mapping import Enough, Mapped, led, turning
from pix2pred.structs import Task, Vocabulary


def connected(at: SpotAt, certificate: Path | None) -> SpotSession:
    """A session that is not open yet; name and password come from the environment or are asked for."""
    where = Address(at.host, at.port, str(certificate) if certificate else None)
    return SpotSession(where, credentials(), SpotSettings())


def spot(
    session: SpotSession, outliner: Outliner, programs: Repertoire, task: Task, words: Vocabulary, memory: RobotMemory
) -> Spot:
    """A Spot with the programs for a task."""
    return Spot(f"the Spot at {session.where}", session, outliner, task.objects, Hand(programs, words), memory)


def checked(session: SpotSession) -> list[CheckedPart]:
    """What there is to know before it moves; the session is opened and closed."""
    try:
        session.open()
        return check(session)
    finally:
        session.close()


def mapped(session: SpotSession, size: float, enough: Enough, *, turn: bool) -> Mapped:
    """A map of the tags around; ``turn`` lets the robot stand up and turn. The session is opened and closed."""
    try:
        session.open()
        if not turn:
            return led(session, size, enough)
        session.check()
        session.take()
        return turning(session, size, enough)
    finally:
        session.close()
