"""First states of several tasks are labelled side by side, and every question names its task."""

from __future__ import annotations

import threading

from pix2pred.execution import Solver
from pix2pred.predicates import LabelSettings, labeller_for
from pix2pred.registry import REGISTRY
from pix2pred.structs import Task, Vocabulary, WorldModel
from pix2pred.vlm import Answer, Request, Together
from predicates.scripted import COOKED, OBJECTS, P1, PICK, TYPES, state


class Meeting:
    """Answers only when as many questions are under way as it waits for."""

    name = "meeting"

    def __init__(self, questions: int) -> None:
        self.all_here = threading.Barrier(questions, timeout=60)
        self.about: list[str] = []

    def answer(self, request: Request) -> Answer:
        self.about.append(request.about)
        self.all_here.wait()
        return Answer("* cooked(patty1): True\n* cooked(patty2): False")


def test_first_states_are_asked_about_together_and_named() -> None:
    model = WorldModel(Vocabulary("v", TYPES, (PICK,), ()), (COOKED,), (), "meeting")
    meeting = Meeting(3)
    labeller = labeller_for(meeting, LabelSettings(), Together(3))
    solver = Solver(model, REGISTRY.planner("portfolio"), labeller)
    solver.look_ahead([Task(f"t{i}", OBJECTS, state(i), (COOKED(P1),)) for i in range(3)])
    assert sorted(meeting.about) == [f"task t{i}, state 0" for i in range(3)]
