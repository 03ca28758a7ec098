"""Searches in sequence: the next one runs when the one before used up its budget."""

from __future__ import annotations

from dataclasses import dataclass

from pix2pred.planning.search.search import Search, SearchResult
from pix2pred.planning.strips import Strips
from pix2pred.structs import PlanStatus


@dataclass(frozen=True, slots=True)
class Portfolio:
    """For example optimal A* on a small budget, then greedy search on a large one."""

    searches: tuple[Search, ...]

    def __call__(self, task: Strips) -> SearchResult:
        """The first result that is not BUDGET, with nodes summed over the searches that ran."""
        nodes = 0
        for search in self.searches:
            found = search(task)
            nodes += found.nodes
            if found.status != PlanStatus.BUDGET:
                return SearchResult(found.status, found.plan, nodes)
        return SearchResult(PlanStatus.BUDGET, (), nodes)
