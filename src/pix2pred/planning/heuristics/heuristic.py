"""What a heuristic is: an estimate of how many steps a state is from the goal, usable by every search."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

from pix2pred.planning.strips import Strips


@dataclass(frozen=True, slots=True)
class Evaluation:
    """What a heuristic says about a state.

    ``estimate`` is the number of steps to the goal. Bit k of ``preferred`` is set when operator k is worth trying first
    there; without advice no bit is set.
    """

    estimate: int
    preferred: int = 0


class Heuristic(ABC):
    """Estimates how many steps a state is from the goal of one task.

    A heuristic is a class in a file of its own that is made from a task and has ``__call__``. It may also improve
    on the other two methods, which every search calls and which work for every heuristic as they are here.
    """

    @abstractmethod
    def __init__(self, task: Strips) -> None:
        """Prepare for the states of ``task``."""

    @abstractmethod
    def __call__(self, state: int) -> int | None:
        """The estimate for ``state``; ``None`` when no plan leads from it to the goal.

        An estimate that is never larger than the length of a shortest plan is called admissible.
        """

    def after(self, parent: int, k: int, state: int) -> int | None:
        """The estimate for ``state``, which operator ``k`` made of ``parent``, a state that was estimated before."""
        return self(state)

    def evaluate(self, state: int) -> Evaluation | None:
        """The estimate for ``state`` with the operators to try first; ``None`` when no plan leads to the goal."""
        estimate = self(state)
        return None if estimate is None else Evaluation(estimate)
