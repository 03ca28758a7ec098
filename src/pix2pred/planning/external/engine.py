"""The program behind ``external``: a task in numbers from stdin, an engine of unified-planning, the answer on stdout.

    python -m pix2pred.planning.external.engine ENGINE SECONDS < task.json

It runs as a process of its own because engines are under other licences, print what they like, and may never end.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import sys
from types import FrameType
from typing import Any


def main() -> None:
    """Solve the task; the last line of stdout is the answer as JSON."""
    engine, seconds = sys.argv[1], float(sys.argv[2])
    task = json.load(sys.stdin)
    signal.signal(signal.SIGTERM, _leave)
    _limit_processor_time(seconds)
    with contextlib.redirect_stdout(sys.stderr):
        answer = _solve(engine, task, seconds)
    print(json.dumps(answer))


def _solve(engine: str, task: dict[str, Any], seconds: float) -> dict[str, Any]:
    from unified_planning.environment import get_environment

    environment = get_environment()  # some engines do not work in any other
    environment.credits_stream = None
    in_pddl = "domain" in task
    problem = _read(task, environment) if in_pddl else _problem(task, environment)
    with environment.factory.OneshotPlanner(name=engine) as planner:
        if not planner.supports(problem.kind):
            return {"status": "UNSUPPORTED_PROBLEM", "message": f"it cannot do all of {sorted(problem.kind.features)}"}
        try:
            result = planner.solve(problem, timeout=seconds)
        finally:
            running = getattr(planner, "_process", None)  # engines that are programs run in a session of their own
            if running is not None:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(running.pid, signal.SIGKILL)
    steps = result.plan.actions if result.plan is not None else []
    logs = " ".join(m.message.strip() for m in result.log_messages or [] if m.level.name == "ERROR")
    return {
        "status": result.status.name,
        "plan": [
            [n if in_pddl else int(n[1:]) for n in map(str, (s.action.name, *s.actual_parameters))] for s in steps
        ],
        "message": " ".join(logs.split())[-300:],
    }


def _read(task: dict[str, Any], environment: Any) -> Any:
    """The problem of two PDDL texts."""
    from unified_planning.io import PDDLReader

    return PDDLReader(environment).parse_problem_string(task["domain"], task["problem"])


def _problem(task: dict[str, Any], environment: Any) -> Any:
    """The task with names that are a letter and a number: t, p, a, o, x."""
    from unified_planning.model import Fluent, InstantaneousAction, Object, Problem

    manager = environment.type_manager
    types: dict[int, Any] = {}

    def user_type(i: int) -> Any:
        if i not in types:
            parent = task["types"][i]
            types[i] = manager.UserType(f"t{i}", None if parent is None else user_type(parent))
        return types[i]

    problem = Problem("task", environment)
    fluents = [
        Fluent(f"p{i}", manager.BoolType(), environment=environment, **{f"x{j}": user_type(t) for j, t in enumerate(a)})
        for i, a in enumerate(task["predicates"])
    ]
    for fluent in fluents:
        problem.add_fluent(fluent, default_initial_value=False)
    objects = [Object(f"o{i}", user_type(t), environment) for i, t in enumerate(task["objects"])]
    problem.add_objects(objects)
    for k, a in enumerate(task["actions"]):
        parameters = {f"x{j}": user_type(t) for j, t in enumerate(a["parameters"])}
        action = InstantaneousAction(f"a{k}", _env=environment, **parameters)
        for p, *xs in a["pre"]:
            action.add_precondition(fluents[p](*(action.parameter(f"x{x}") for x in xs)))
        for key, value in (("delete", False), ("add", True)):
            for p, *xs in a[key]:
                action.add_effect(fluents[p](*(action.parameter(f"x{x}") for x in xs)), value)
        problem.add_action(action)
    for p, *os_ in task["initial"]:
        problem.set_initial_value(fluents[p](*(objects[o] for o in os_)), True)
    for p, *os_ in task["goal"]:
        problem.add_goal(fluents[p](*(objects[o] for o in os_)))
    return problem


def _limit_processor_time(seconds: float) -> None:
    """Nothing this program starts may compute for longer, whoever stops watching it (children inherit the limit)."""
    try:
        import resource
    except ImportError:  # not on Windows
        return
    limit = int(seconds) + 10
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))


def _leave(_signal: int, _frame: FrameType | None) -> None:
    sys.exit(1)


if __name__ == "__main__":
    main()
