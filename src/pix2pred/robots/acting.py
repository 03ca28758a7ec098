"""One task on a robot: look, plan, run a skill, look again, and plan again when it has to be (method 8.5).

The plan is followed by the same rules as in the closed loop of simulated tasks and with a person's hands. Whether the
goal is reached is what the looks say: a robot knows no truth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

from pix2pred.execution import Guided, PlannedScene, SeenStep, Solver, assume_all, plan_scene
from pix2pred.robots.robot import Outcome, Robot, RobotError
from pix2pred.structs import Task
from pix2pred.structs.environment import Step, StepStatus


class Watcher(Protocol):
    """Who is told what happens, and who may stop it."""

    def may_move(self, robot: Robot) -> bool:
        """The robot is connected and nothing has moved yet; whether it may stand up and look around."""
        ...

    def planned(self, scene: PlannedScene) -> bool:
        """There is a plan, and no skill was run yet; whether to begin."""
        ...

    def about_to(self, guided: Guided) -> bool:
        """The next step is ``guided.step``; whether to go on."""
        ...

    def looked(self, guided: Guided, look: SeenStep, step: Step) -> None:
        """A step was run and looked at."""
        ...


class Unwatched:
    """Begins, and goes on."""

    def may_move(self, robot: Robot) -> bool:
        return True

    def planned(self, scene: PlannedScene) -> bool:
        return True

    def about_to(self, guided: Guided) -> bool:
        return True

    def looked(self, guided: Guided, look: SeenStep, step: Step) -> None:
        pass


@dataclass(frozen=True, slots=True)
class RanSkill:
    """A skill that was run, and how it ended as the robot says."""

    action: str
    status: StepStatus
    detail: str = ""


@dataclass(slots=True)
class TaskRun:
    """How the work on a task went."""

    task: str
    outcome: Outcome = Outcome.STOPPED
    detail: str = ""
    plan: tuple[str, ...] = ()
    skills: list[RanSkill] = field(default_factory=list)
    replans: int = 0
    under_way: str = ""
    """The skill that was begun and whose end is not known."""

    def as_dict(self) -> dict[str, Any]:
        """The same for programs."""
        return {
            "task": self.task,
            "outcome": self.outcome.name.lower().replace("_", "-"),
            "detail": self.detail,
            "plan": list(self.plan),
            "skills": [{"action": s.action, "status": s.status.value, "detail": s.detail} for s in self.skills],
            "replans": self.replans,
            "under_way": self.under_way,
        }


MOST_SKILLS = 60
"""Skills run in one task; a task that needs more goes in circles."""


def act(
    robot: Robot, task: Task, solver: Solver, watcher: Watcher, remember: Callable[[TaskRun], None] = lambda run: None
) -> TaskRun:
    """Work on ``task``, whose initial state is what the robot sees first; gives how it went, and never raises for it.

    ``robot`` is entered here and left in every case. ``remember`` is told before and after every skill.
    """
    run = TaskRun(task.name)
    try:
        with robot:
            _work(robot, task, solver, watcher, run, remember)
    except RobotError as error:
        run.outcome, run.detail = error.outcome, str(error)
    except KeyboardInterrupt:
        run.outcome, run.detail = Outcome.STOPPED, "interrupted; the same command goes on from what is there then"
    remember(run)
    return run


def _work(
    robot: Robot, task: Task, solver: Solver, watcher: Watcher, run: TaskRun, remember: Callable[[TaskRun], None]
) -> None:
    if not watcher.may_move(robot):
        run.outcome, run.detail = Outcome.DECLINED, "nothing was moved"
        return
    robot.start()
    seen = replace(task, initial=robot.observe())
    scene = plan_scene(solver, seen)
    run.plan = scene.actions
    if not scene.solved:
        run.outcome, run.detail = Outcome.NO_PLAN, f"no plan from what was seen first ({scene.result.status})"
        return
    if not watcher.planned(scene):
        run.outcome, run.detail = Outcome.DECLINED, "the robot has looked around, and no skill was run"
        return
    guided = Guided(scene, may_assume=assume_all)  # the watcher may stop before every skill
    while guided.step is not None and len(run.skills) < MOST_SKILLS:
        if not watcher.about_to(guided):
            run.outcome, run.detail = Outcome.STOPPED, "stopped before the next skill"
            return
        action = guided.step.action
        run.under_way = str(action)
        remember(run)
        step = robot.execute(action)
        run.under_way = ""
        run.skills.append(RanSkill(str(action), step.status, step.detail))
        remember(run)
        look = guided.observe(robot.observe(), told=True, reported=step.status)
        run.replans = guided.replans
        watcher.looked(guided, look, step)
    if guided.reached:
        run.outcome, run.detail = Outcome.GOAL, "the goal holds in what was seen last"
    else:
        run.outcome = Outcome.GAVE_UP
        run.detail = guided.ended or f"{MOST_SKILLS} skills were run"
