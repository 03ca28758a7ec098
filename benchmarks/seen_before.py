"""What many runs on the same tasks share: the pictures of a simulator, and a deterministic model's answers.

Simulators and the offline reader give the same again for the same again, and conditions of a benchmark differ in labels
alone for most of the time; so a picture is drawn once, and read once.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from pix2pred.structs import Action, State
from pix2pred.structs.environment import Environment, Step
from pix2pred.structs.samplers import Features
from pix2pred.vlm import VLM, Answer, Request

History = tuple[object, ...]
"""What distinguishes an episode's start from others, and the skills executed since."""


@dataclass
class Redrawn:
    """An environment whose states are kept in ``seen`` by what was executed since ``start``."""

    environment: Environment
    seen: dict[History, State]
    start: History
    _history: History = ()

    def reset(self) -> None:
        self.environment.reset()
        self._history = ()

    def observe(self) -> State:
        key = (*self.start, *self._history)
        if key not in self.seen:
            self.seen[key] = self.environment.observe()
        return self.seen[key]

    def features(self) -> Features:
        return self.environment.features()

    def execute(self, action: Action) -> Step:
        self._history = (*self._history, action)
        return self.environment.execute(action)

    def goal_reached(self) -> bool:
        return self.environment.goal_reached()


@dataclass
class Reread:
    """A deterministic model; ``answers`` keeps what it said, by question."""

    model: VLM
    answers: dict[str, Answer] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return self.model.name

    def answer(self, request: Request) -> Answer:
        key = f"{request.purpose} {request.key(self.model.name)}"
        if key not in self.answers:
            self.answers[key] = self.model.answer(request)
        return replace(self.answers[key])
