"""Planning with engines of others, out of process, through unified-planning (the extra ``planners``).

The task goes to ``external_engine``, a program of its own, as numbers, and the plan comes back as numbers: no names to
escape, no licence to mix, and an engine that crashes or hangs takes nothing with it. Every plan is checked here.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import permutations
from typing import Any

from pix2pred.planning.validate import is_valid
from pix2pred.structs import AbstractState, Atom, GroundOperator, Object, Operator, PlanResult, PlanStatus, Type
from pix2pred.system.errors import Pix2predError
from pix2pred.system.extras import install_command

ENGINES = {
    "aries": "up-aries",
    "enhsp": "up-enhsp",
    "enhsp-opt": "up-enhsp",
    "fast-downward": "up-fast-downward",
    "fast-downward-opt": "up-fast-downward",
    "lpg": "up-lpg",
    "pyperplan": "up-pyperplan",
    "pyperplan-opt": "up-pyperplan",
    "symk": "up-symk",
    "symk-opt": "up-symk",
    "tamer": "up-tamer",
}
"""Engines that unified-planning knows, and the package that brings each."""

IN_EXTRA = {"up-fast-downward", "up-pyperplan"}
TIME_LIMIT = 300.0
"""Seconds."""
_FAREWELL = 5.0
"""Seconds the program has to stop its engine, before it is killed."""

_STATUS = {
    "SOLVED_SATISFICING": PlanStatus.SOLVED,
    "SOLVED_OPTIMALLY": PlanStatus.SOLVED,
    "UNSOLVABLE_PROVEN": PlanStatus.UNSOLVABLE,
    "UNSOLVABLE_INCOMPLETELY": PlanStatus.NOT_FOUND,
    "TIMEOUT": PlanStatus.TIMEOUT,
    "MEMOUT": PlanStatus.BUDGET,
}


class ExternalPlannerError(Pix2predError, RuntimeError):
    """An engine that is not installed, does not support the task, crashed, or gave a plan that does not work."""


@dataclass(frozen=True, slots=True)
class ExternalPlanner:
    """Plans with ``engine``, a key of ``ENGINES``. Raises ``ExternalPlannerError`` at once when it is not installed.

    ``time_limit`` is in seconds of wall time, starting the program included. It is the one limit that depends on the
    machine: running into it is an outcome of its own, TIMEOUT. Nodes are unknown.
    """

    engine: str
    distinct: bool = True
    time_limit: float = TIME_LIMIT

    def __post_init__(self) -> None:
        package = ENGINES[self.engine]
        needed = ("unified_planning", package.replace("-", "_"))
        if any(find_spec(module) is None for module in needed):
            install = install_command("planners") + ("" if package in IN_EXTRA else f" {package}")
            raise ExternalPlannerError(f"planner {self.engine} is not installed; {install}")

    def plan(
        self, operators: Sequence[Operator], objects: Iterable[Object], initial: AbstractState, goal: Iterable[Atom]
    ) -> PlanResult:
        """Look for a plan from ``initial`` to a state that contains ``goal``. Raises ``ExternalPlannerError``."""
        start = time.perf_counter()
        effective = [op for op in operators if op.add or op.delete]
        things, wanted = sorted(objects), tuple(goal)
        answer = self._ask(_numbered(effective, things, initial, wanted, distinct=self.distinct))
        status = self._status(answer)
        plan: tuple[GroundOperator, ...] = ()
        if answer is not None and status == PlanStatus.SOLVED:
            plan = tuple(effective[k].ground(tuple(things[i] for i in bound)) for k, *bound in answer["plan"])
            if not is_valid(plan, initial, wanted):
                raise ExternalPlannerError(f"planner {self.engine} gave a plan that does not work")
        return PlanResult(status, plan, None, time.perf_counter() - start)

    def plan_text(self, domain: str, problem: str) -> tuple[PlanStatus, tuple[str, ...]]:
        """Look for a plan of a problem in PDDL; its steps as ``(action object ...)``, not checked.

        Raises ``ExternalPlannerError``.
        """
        answer = self._ask({"domain": domain, "problem": problem})
        status = self._status(answer)
        steps = answer["plan"] if answer is not None and status == PlanStatus.SOLVED else ()
        return status, tuple(f"({' '.join(step)})" for step in steps)

    def _status(self, answer: dict[str, Any] | None) -> PlanStatus:
        """How the engine ended. Raises ``ExternalPlannerError`` when it failed."""
        if answer is None:
            return PlanStatus.TIMEOUT
        if answer["status"] not in _STATUS:
            raise ExternalPlannerError(f"planner {self.engine} failed: {answer['status']}: {answer['message']}")
        return _STATUS[answer["status"]]

    def _ask(self, task: dict[str, Any]) -> dict[str, Any] | None:
        """The answer of the program; ``None`` when it ran out of time."""
        command = [sys.executable, "-m", "pix2pred.planning.external.engine", self.engine, str(self.time_limit)]
        with subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True
        ) as program:
            try:
                out, err = program.communicate(json.dumps(task).encode(), timeout=self.time_limit)
            except subprocess.TimeoutExpired:
                return None
            finally:
                _stop(program)
        lines = out.decode(errors="replace").splitlines()
        if program.returncode != 0 or not lines:
            complaint = err.decode(errors="replace").strip().splitlines() or [f"exit code {program.returncode}"]
            raise ExternalPlannerError(f"planner {self.engine} failed: {complaint[-1]}")
        try:
            answer: dict[str, Any] = json.loads(lines[-1])
        except ValueError as error:
            raise ExternalPlannerError(f"planner {self.engine} failed: its answer cannot be read") from error
        return answer


def _stop(program: subprocess.Popen[bytes]) -> None:
    """End the program if it still runs; it ends its engine."""
    if program.poll() is None:
        program.terminate()
        try:
            program.communicate(timeout=_FAREWELL)
        except subprocess.TimeoutExpired:
            program.kill()


# Longer than others: one numbering of types, predicates and objects serves all parts of the task.
def _numbered(
    operators: Sequence[Operator],
    objects: Sequence[Object],
    initial: AbstractState,
    goal: Sequence[Atom],
    *,
    distinct: bool,
) -> dict[str, Any]:
    """The task in numbers; distinct parameters become a predicate that holds between different objects.

    (Engines without inequality are many, engines without predicates are none.)
    """
    types: dict[Type, int] = {}

    def type_number(t: Type) -> int:
        if t.parent is not None:
            type_number(t.parent)
        return types.setdefault(t, len(types))

    found = {a.predicate for a in (*initial, *goal)}
    found |= {a.predicate for op in operators for a in (*op.preconditions, *op.add, *op.delete)}
    predicates = {p: i for i, p in enumerate(sorted(found))}
    number = {o: i for i, o in enumerate(objects)}
    strangers = sorted(o for a in (*initial, *goal) for o in a.objects if o not in number)
    if strangers:
        raise ValueError(f"{strangers[0].name} is not among the objects of the task")
    different = len(predicates)

    def action(op: Operator) -> dict[str, Any]:
        place = {v: i for i, v in enumerate(op.parameters)}
        groups = {"pre": op.preconditions, "add": op.add, "delete": op.delete}
        lifted = {
            k: [[predicates[a.predicate], *(place[v] for v in a.variables)] for a in sorted(g)]
            for k, g in groups.items()
        }
        pairs = [
            [different, i, j]
            for i, a in enumerate(op.parameters)
            for j, b in enumerate(op.parameters[:i])
            if distinct and (a.type.is_a(b.type) or b.type.is_a(a.type))
        ]
        lifted["pre"] += pairs
        return {"parameters": [type_number(v.type) for v in op.parameters], **lifted}

    facts = [[predicates[a.predicate], *(number[o] for o in a.objects)] for a in sorted(initial)]
    actions = [action(op) for op in operators]
    kinds = [type_number(o.type) for o in objects]
    arguments = [[type_number(t) for t in p.types] for p in predicates]
    root = type_number(Type("object"))
    if any(p[0] == different for a in actions for p in a["pre"]):
        arguments.append([root, root])
        facts += [[different, i, j] for i, j in permutations(range(len(objects)), 2)]
    parents = [types[t.parent] if t.parent is not None else (None if i == root else root) for t, i in types.items()]
    return {
        "types": parents,
        "predicates": arguments,
        "actions": actions,
        "objects": kinds,
        "initial": facts,
        "goal": [[predicates[a.predicate], *(number[o] for o in a.objects)] for a in goal],
    }
