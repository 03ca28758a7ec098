"""The folder of a task on a robot: what it saw, ran and holds, so that a stopped session can be gone on with.

robot/<task>/session.json     outcome, skills, the one under way, and what the hand holds
robot/<task>/map.json         the map of tags, when a robot walks by one
robot/<task>/looks/<n>/       the pictures of the n-th look
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from pix2pred.demos import read_task
from pix2pred.execution import Solver
from pix2pred.robots.acting import TaskRun, Watcher, act
from pix2pred.robots.addresses import SimulatedEpisode, SpotAt
from pix2pred.robots.robot import Robot, RobotMemory
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.structs import State, Task, Vocabulary
from pix2pred.structs.environment import Domain

ROBOT, SESSION, MAP, LOOKS = "robot", "session.json", "map.json", "looks"


def task_for(
    address: SimulatedEpisode | SpotAt, folder: Path | None, vocabulary: Vocabulary, domain: Callable[[str], Domain]
) -> Task:
    """The task in ``folder``, or, for a simulated episode, that of the scene. Raises ``RunFolderError``."""
    if folder is not None:
        return read_task(folder, vocabulary).task
    if isinstance(address, SpotAt):
        raise RunFolderError("name the task: --task FOLDER, with the objects there and the goal")
    made = domain(address.domain)
    if address.family not in made.families:
        raise RunFolderError(
            f"{address.domain} has no family {address.family!r}; choose from {', '.join(made.families)}"
        )
    return made.tasks(address.family, address.seed, address.index + 1)[address.index].task


class RobotSession:
    """One task of a run on a robot."""

    def __init__(self, run: RunFolder, task: Task) -> None:
        self._run, self.task = run, task
        self._name = f"{ROBOT}/{task.name}"
        self.path = run.path / self._name
        self._looks = 0
        self._under_way = ""

    def memory(self, map_file: Path | None = None) -> RobotMemory:
        """What is known from the last session; the map is kept in ``map_file``, or here. Raises ``RunFolderError``."""
        self.path.mkdir(parents=True, exist_ok=True)
        file, held = self.path / SESSION, None
        if file.exists():
            try:
                data = json.loads(file.read_text(encoding="utf-8"))
                held, self._under_way = data["holding"], str(data.get("under_way", ""))
            except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
                raise RunFolderError(f"{file}: is damaged ({error}); remove it if the robot's hand is empty") from error
        if held is not None and held not in {o.name for o in self.task.objects}:
            raise RunFolderError(f"{file}: the hand holds {held!r}, which is no object of the task")
        return RobotMemory(map_file or self.path / MAP, held, self._under_way)

    def act(self, robot: Robot, solver: Solver, watcher: Watcher) -> TaskRun:
        """Work on the task; what happened is on disk before and after every skill."""

        def remember(run: TaskRun) -> None:
            if run.skills or run.under_way:
                self._under_way = run.under_way
            left = {"holding": robot.holding, "under_way": self._under_way}
            self._run.write_json(f"{self._name}/{SESSION}", run.as_dict() | left)

        return act(robot, self.task, solver, watcher, remember)

    def keep(self, state: State) -> Path:
        """Write the pictures of a look; gives their folder."""
        self._looks += 1
        name = f"{self._name}/{LOOKS}/{self._looks}"
        for picture in state.pictures:
            self._run.write_bytes(f"{name}/{picture.camera}.png", picture.image.encoded)
        return self._run.path / name
