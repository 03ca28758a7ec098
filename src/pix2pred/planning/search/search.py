"""What a search is: an algorithm from a ground task to a plan of operator numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from pix2pred.planning.strips import Strips
from pix2pred.structs import PlanStatus


@dataclass(frozen=True, slots=True)
class SearchResult:
    """How a search on bits ended: ``plan`` lists operator numbers, ``nodes`` counts created nodes."""

    status: PlanStatus
    plan: tuple[int, ...]
    nodes: int


class Search(Protocol):
    """A search algorithm: A*, greedy best-first, a portfolio of both."""

    def __call__(self, task: Strips) -> SearchResult:
        """Look for a plan of ``task`` within the algorithm's own node budget."""
        ...


def extract_plan(initial: int, state: int, parent: dict[int, tuple[int, int]]) -> tuple[int, ...]:
    """Operator numbers along the links from ``state`` back to ``initial``; a link is (state before, operator)."""
    plan = []
    while state != initial:
        state, k = parent[state]
        plan.append(k)
    return tuple(reversed(plan))
