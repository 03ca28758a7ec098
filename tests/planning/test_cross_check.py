"""Shortest plans of the PDDL problems, found independently by jupyddl (A* with its own grounder and LM-cut)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jupyddl
import pytest
from jupyddl import parser

from pix2pred.planning import AStar, GreedyBestFirst, Planner, is_valid
from pix2pred.structs import (
    Atom,
    FromDomain,
    LiftedAtom,
    Object,
    Operator,
    PlanStatus,
    Predicate,
    Skill,
    Type,
    Variable,
)

FOLDER = Path(__file__).parents[1] / "data" / "pddl"
PROBLEMS = [
    ("kitchen", "kitchen-1"), ("coffee", "coffee-1"), ("coffee", "coffee-2"), ("coffee", "coffee-3"),
    ("cleanup", "cleanup-train1"), ("cleanup", "cleanup-train2"), ("cleanup", "cleanup-novel2"),
    ("juice", "juice-train1"), ("juice", "juice-novel1"), ("more-stacks-burger", "stacks-train1"),
    ("more-stacks-burger", "stacks-train2"), ("bigger-burger", "bigger-train1"), ("bigger-burger", "bigger-train2"),
    ("bigger-burger", "bigger-test1"), ("combo-burger", "combo-train1"), ("combo-burger", "combo-train2"),
    ("combo-burger", "combo-train3"), ("combo-burger", "combo-train4"), ("combo-burger", "combo-test1"),
]  # fmt: skip


class Reader:
    """Operators, objects, initial atoms and goal from the syntax trees of jupyddl's parser."""

    def __init__(self, domain: Any, problem: Any) -> None:
        parents = {child: parent for child, parent in domain.types.items() if child != "object"}
        self._types: dict[str, Type] = {"object": Type("object")}
        for name in parents:
            self._build(name, parents)
        self._predicates = {
            p.name: Predicate(p.name, tuple(self._types["object"] for _ in p.params), FromDomain())
            for p in domain.predicates
        }
        self.objects = {name: Object(name, self._types[t]) for name, t in problem.objects}
        self.operators = tuple(self._operator(action) for action in domain.actions)
        self.initial = frozenset(self._atom(a) for a in problem.init)
        self.goal = tuple(self._atom(part.atom) for part in _parts(problem.goal))

    def _build(self, name: str, parents: dict[str, str]) -> Type:
        if name not in self._types:
            self._types[name] = Type(name, parent=self._build(parents[name], parents))
        return self._types[name]

    def _atom(self, atom: Any) -> Atom:
        return Atom(self._predicates[atom.predicate], tuple(self.objects[a] for a in atom.args))

    def _operator(self, action: Any) -> Operator:
        variables = {name: Variable(name, self._types[t]) for name, t in action.parameters}

        def lift(atoms: list[Any]) -> frozenset[LiftedAtom]:
            return frozenset(
                LiftedAtom(self._predicates[a.predicate], tuple(variables[v] for v in a.args)) for a in atoms
            )

        effects = _parts(action.effect)
        return Operator(
            action.name,
            tuple(variables.values()),
            lift([part.atom for part in _parts(action.precondition)]),
            lift([e.atom for e in effects if isinstance(e, parser.AddEffect)]),
            lift([e.atom for e in effects if isinstance(e, parser.DelEffect)]),
            Skill("Act", ()),
            (),
        )


def _parts(formula: Any) -> list[Any]:
    """The conjuncts of ``formula``."""
    return [p for part in formula.parts for p in _parts(part)] if hasattr(formula, "parts") else [formula]


@pytest.mark.parametrize(("domain", "problem"), PROBLEMS, ids=[p for _, p in PROBLEMS])
def test_plan_lengths_agree_with_jupyddl(domain: str, problem: str) -> None:
    domain_file, problem_file = FOLDER / f"{domain}-domain.pddl", FOLDER / f"{problem}.pddl"
    task = jupyddl.build_task(str(domain_file), str(problem_file))
    theirs = jupyddl.solve_task(task, "astar", "lmcut")
    assert theirs.plan is not None
    read = Reader(parser.parse_domain_file(str(domain_file)), parser.parse_problem_file(str(problem_file)))
    for search in (AStar(), GreedyBestFirst()):
        ours = Planner(search, distinct=False).plan(read.operators, read.objects.values(), read.initial, read.goal)
        assert ours.status == PlanStatus.SOLVED
        assert is_valid(ours.plan, read.initial, read.goal)
        assert len(ours.plan) == len(theirs.plan) if isinstance(search, AStar) else True
        steps = [f"{g.operator.name}({','.join(o.name for o in g.objects)})" for g in ours.plan]
        by_name = {op.name.replace(" ", ""): op for op in task.operators}
        assert jupyddl.validate_plan(task, [by_name[step] for step in steps])
