"""A run folder with a world model written by hand: taking the eraser from the table, and wiping. Nothing is learned.

It is worked with as the command line does, against a simulated Spot in this process.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import yaml

from pix2pred.api import load_solver
from pix2pred.domains.cleanup import CleanupDomain
from pix2pred.domains.cleanup.vocabulary import (
    HAND_EMPTY,
    HOLDING,
    MOVABLE,
    PICK_FROM_TOP,
    ROBOT,
    TABLE,
    WIPE,
    WIPED,
)
from pix2pred.registry import REGISTRY
from pix2pred.robots.acting import TaskRun, Unwatched
from pix2pred.robots.simulator.server import SpotServer
from pix2pred.robots.spot.settings import SpotSettings
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.layout import CONFIG, MODEL
from pix2pred.runs.robot_session import RobotSession
from pix2pred.settings import Settings
from pix2pred.structs import FromVLM, LiftedAtom, Operator, Predicate, Task, Variable, WorldModel
from pix2pred.structs.formats.world_model import dump_model
from pix2pred.vlm import AnswerStore
from robots.simulated_spots import PATIENT, spot_for

FAMILY, INDEX = "new-objects", 2
"""The task that the model is for: the eraser, and nothing else, lies on the scribbled table."""

_IS_ON = Predicate("IsOn", (MOVABLE, TABLE), FromVLM("IsOn"))


def write_run(folder: Path) -> Path:
    """A run folder at ``folder``; labels come from the reader of Cleanup."""
    words = CleanupDomain().vocabulary(FAMILY)
    robot, thing, table = Variable("?r", ROBOT), Variable("?m", MOVABLE), Variable("?t", TABLE)
    empty, holding = LiftedAtom(HAND_EMPTY, (robot,)), LiftedAtom(HOLDING, (robot, thing))
    lies = LiftedAtom(_IS_ON, (thing, table))
    all_three = (robot, thing, table)
    operators = (
        Operator(
            "Take", all_three, frozenset({empty, lies}), frozenset({holding}), frozenset({empty, lies}),
            PICK_FROM_TOP, all_three, 5,
        ),
        Operator(
            "Wipe", all_three, frozenset({holding}), frozenset({LiftedAtom(WIPED, (table,))}), frozenset(),
            WIPE, all_three, 5,
        ),
    )  # fmt: skip
    labelled_by = REGISTRY.stored("offline", words.name, AnswerStore(folder)).name
    model = WorldModel(words, (_IS_ON,), operators, labelled_by)
    (folder / MODEL).parent.mkdir(parents=True)
    (folder / MODEL).write_text(dump_model(model), encoding="utf-8")
    config = {
        "answers": None, "data": "", "model": labelled_by, "vlm": "offline",
        "settings": Settings().model_dump(mode="json"), "simulator": {"domain": words.name, "family": FAMILY},
    }  # fmt: skip
    (folder / CONFIG).write_text(yaml.safe_dump(config), encoding="utf-8")
    return folder


def work(server: SpotServer, folder: Path, task: Task, answer: float = PATIENT.answer) -> TaskRun:
    """Work on ``task`` with the run in ``folder``, or go on with it; an answer is waited for so many seconds."""
    settings = SpotSettings(deadlines=replace(PATIENT, answer=answer), poll=0.02, estop_timeout=90.0)
    with RunFolder(folder).locked() as locked:
        solver, _ = load_solver(locked, "portfolio", closed_loop=True)
        session = RobotSession(locked, task)
        return session.act(spot_for(server, "cleanup", task, session.memory(), settings), solver, Unwatched())


def put_right(server: SpotServer) -> None:
    """The tablet gives the robot back, the button is released, people help it up and change its battery."""

    def right() -> None:
        body = server.spot.body
        body.leases.owner, body.stops.pressed, body.fallen = "", False, False
        body.charge, body.silent_cameras = 83.0, False
        server.spot.faults.planned = ()

    server.spot.do(right)
