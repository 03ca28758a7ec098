"""A heuristic and a search from outside the package: the examples of docs/extending.md, word for word."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from doc_runner import defined_in_extending
from pix2pred import planners, registry
from pix2pred.planning import AStar, GreedyBestFirst, Planner
from pix2pred.structs import PlanStatus
from planning.random_tasks import random_strips, run, shortest


@given(st.integers(0, 2**32))
@settings(max_examples=100, deadline=None)
def test_a_heuristic_from_outside_serves_every_search_here(seed: int) -> None:
    task = random_strips(seed)
    length = shortest(task)
    for search in (GreedyBestFirst(defined_in_extending("MissingGoals")), AStar(defined_in_extending("MissingGoals"))):
        found = search(task)
        assert found.status == (PlanStatus.UNSOLVABLE if length is None else PlanStatus.SOLVED)
        final = run(task, found.plan)
        assert final is not None and (length is None or task.is_goal(final))


@given(st.integers(0, 2**32))
@settings(max_examples=100, deadline=None)
def test_a_search_from_outside_finds_what_there_is(seed: int) -> None:
    task = random_strips(seed)
    length, found = shortest(task), defined_in_extending("breadth_first")(task)
    assert found.status == (PlanStatus.UNSOLVABLE if length is None else PlanStatus.SOLVED)
    assert length is None or len(found.plan) == length


def test_one_line_of_the_registry_names_it(monkeypatch: pytest.MonkeyPatch) -> None:
    heuristic = defined_in_extending("MissingGoals")
    monkeypatch.setitem(planners.HEURISTICS, "goals", heuristic)
    assert registry.load_planner("astar-goals") == Planner(AStar(heuristic))
    assert registry.load_planner("gbfs-goals") == Planner(GreedyBestFirst(heuristic))


def test_the_names_of_planners() -> None:
    assert {"astar-lmcut", "gbfs-ff", "portfolio"} <= set(registry.planner_names())
    for name in registry.planner_names():
        assert isinstance(registry.load_planner(name), Planner)
