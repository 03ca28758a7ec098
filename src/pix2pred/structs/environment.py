"""What a simulator or a robot offers to the rest of the system. ``docs/your_own_domain.md`` walks through it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from pix2pred.structs.demos import Demo, Task, Vocabulary
from pix2pred.structs.samplers import Features
from pix2pred.structs.skills import Action
from pix2pred.structs.states import Pixels, State

SimulatorState = Mapping[str, Any]
"""A simulator's own description of a state, JSON-compatible; only that simulator reads it."""


class StepStatus(StrEnum):
    """How the execution of one skill ended."""

    DONE = "done"
    STUCK = "skill failure"
    HORIZON = "horizon"
    """The skill was not begun or not ended: what an episode may
    take was used up."""


@dataclass(frozen=True, slots=True)
class Step:
    """How the try of a skill ended, and a sentence about it when it failed."""

    status: StepStatus
    detail: str = ""


@dataclass(frozen=True, slots=True)
class SimulatedTask:
    """A task as a solver sees it, with the simulator's own state kept apart."""

    task: Task
    simulator: SimulatorState


class Environment(Protocol):
    """One episode of one task. Only pictures, features and given atoms leave it.

    Executing and observing are separate, because an open-loop plan looks at nothing and pictures are costly.
    """

    def reset(self) -> None:
        """Start the episode over."""
        ...

    def observe(self) -> State:
        """The state now."""
        ...

    def features(self) -> Features:
        """The features of ``observe()``, without drawing. Samplers of continuous parameters ask for them."""
        ...

    def execute(self, action: Action) -> Step:
        """Run one skill, with its continuous parameters if any, until it ends, gets stuck, or uses up the horizon.

        Never raises: whatever goes wrong, be it bad parameters, an unreachable pose or physics that diverges, is a
        ``Step`` with a sentence about the cause.
        """
        ...

    def goal_reached(self) -> bool:
        """Whether the task's true goal holds now."""
        ...


FrameSink = Callable[[Pixels], None]
"""Takes one frame of a film."""


@runtime_checkable
class Filmed(Protocol):
    """An environment that can show a skill while it runs; others are filmed as one picture before and after it."""

    def film(self, sink: FrameSink | None) -> None:
        """From now on hand ``sink`` a frame about every tenth of a simulated second; ``None`` stops."""
        ...


@runtime_checkable
class Asking(Protocol):
    """A domain that wants a model to be asked in other ways than by default."""

    def asking(self, family: str) -> Mapping[str, Mapping[str, Any]]:
        """Settings of the sections ``proposal`` and ``labels``."""
        ...


def asking_settings(domain: object, family: str) -> Mapping[str, Mapping[str, Any]]:
    """How a model is to be asked about a domain's pictures, where the domain says so."""
    return domain.asking(family) if isinstance(domain, Asking) else {}


class Domain(Protocol):
    """A simulated domain: its families of demonstrations and tasks, and how to run them."""

    name: str
    families: Sequence[str]
    reader: Path | None
    """Folder with the offline reader's word list and weights, if the domain has one."""

    def vocabulary(self, family: str) -> Vocabulary:
        """Types, skills and initial predicates of a family."""
        ...

    def settings(self, family: str) -> Mapping[str, Any]:
        """The published learning settings of a family (method 10.7)."""
        ...

    def demonstrations(self, family: str, seed: int) -> Sequence[Demo]:
        """Rendered demonstrations."""
        ...

    def tasks(self, family: str, seed: int, count: int) -> Sequence[SimulatedTask]:
        """Unseen test tasks."""
        ...

    def environment(self, task: Task, simulator: SimulatorState, disturb: float = 0.0) -> Environment:
        """A fresh episode of a task; ``disturb`` is the probability that the scene is disturbed after a skill."""
        ...


@runtime_checkable
class NeedsMore(Protocol):
    """A domain whose simulator is an extra: asked before long work begins."""

    def check_installed(self) -> None:
        """Raises ``ImportError`` with the command that installs what is missing."""
        ...


@runtime_checkable
class KnowsTruth(Protocol):
    """A domain that knows what visual predicates mean. Used once a task has failed, to name the cause, never before."""

    def concept_holds(self, environment: Environment, concept: str, names: Sequence[str]) -> bool | None:
        """Whether ``concept`` is true of the objects called ``names`` in the environment's present state.

        ``concept`` is what the reader's word list calls the meaning of a phrase; for a domain without a reader it is
        the phrase itself. ``None`` for concepts without a ground truth.
        """
        ...


@runtime_checkable
class Replayable(Protocol):
    """A domain that gives the start of each demonstration, so that its states can be visited again.

    With the truth of words this tells a wrong label in a demonstration from a wrong model.
    """

    def demonstration_starts(self, family: str, seed: int) -> Sequence[SimulatedTask]:
        """The initial states of ``demonstrations(family, seed)``, in the same order."""
        ...


@runtime_checkable
class Sized(Protocol):
    """A domain that makes test tasks of a chosen size, for the sweep over ``items``."""

    def sized_tasks(self, family: str, seed: int, count: int, items: int) -> Sequence[SimulatedTask]:
        """``count`` tasks with ``items`` movable things. Raises ``ValueError`` when the family has none."""
        ...
