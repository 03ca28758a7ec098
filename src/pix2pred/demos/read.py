"""Reading project folders; whatever is wrong with them is said by file and line."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

from pix2pred.demos.declared import Declared, build_declared, resolve_objects
from pix2pred.demos.files.documents import DemoDoc, DomainDoc, TaskDoc, load_document
from pix2pred.demos.files.folders import (
    DEMO,
    DEMOS,
    DOMAIN,
    IMAGES,
    MISSING,
    SIMULATOR,
    TASK,
    TASKS,
    is_folder,
    named_folders,
    refusal,
)
from pix2pred.demos.files.problems import FolderError, Problem, in_reading_order
from pix2pred.demos.goals import check_features, check_goals
from pix2pred.demos.pictures import check_image_folders
from pix2pred.demos.scenes import SceneReader
from pix2pred.structs import Demo, Task, Vocabulary


@dataclass(frozen=True, slots=True)
class Project:
    """A project folder: what is declared and demonstrated.

    ``learning`` holds settings as written, ``asking`` those of the sections ``proposal`` and ``labels``; ``simulator``
    names the registered domain and its family, if any.
    """

    vocabulary: Vocabulary
    demos: tuple[Demo, ...]
    learning: Mapping[str, Any]
    simulator: Mapping[str, str] | None
    asking: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @property
    def sections(self) -> dict[str, dict[str, Any]]:
        """All settings of the project, by section."""
        return {"learning": dict(self.learning)} | {name: dict(values) for name, values in self.asking.items()}


@dataclass(frozen=True, slots=True)
class StoredTask:
    """A task on disk. ``simulator`` is the simulator's own state, for the simulator alone; None without a file."""

    task: Task
    simulator: Mapping[str, Any] | None
    simulator_path: Path


def read_project(directory: Path) -> Project:
    """Read declarations and demonstrations (in natural order of their names); pictures are decoded when used.

    Raises ``FolderError`` with every problem found.
    """
    found: list[Problem] = []
    project, _ = collect_project(directory, found)
    if found or project is None:
        raise FolderError(in_reading_order(found))
    return project


def read_tasks(directory: Path, vocabulary: Vocabulary) -> tuple[StoredTask, ...]:
    """Read ``directory/tasks``. ``vocabulary`` may come from a world model: ``domain.yaml`` is then not needed.

    Raises ``FolderError`` with every problem found.
    """
    found: list[Problem] = []
    if not is_folder(directory):
        found.append(Problem(directory, None, "is not a folder"))
    tasks = collect_tasks(directory, declared_for_tasks(directory, vocabulary, found), found)
    if found:
        raise FolderError(in_reading_order(found))
    return tasks


def declared_for_tasks(directory: Path, vocabulary: Vocabulary, found: list[Problem]) -> Declared:
    """``vocabulary`` with the objects of ``domain.yaml``, where there is one; problems go to ``found``."""
    if refusal(directory / DOMAIN, directory) != MISSING and (
        loaded := load_document(directory / DOMAIN, directory, DomainDoc, found)
    ):
        types = {t.name: t for t in vocabulary.types}
        broken: set[str] = set()
        objects = resolve_objects(loaded[0], loaded[1].objects, types, broken)
        return Declared(vocabulary, objects, frozenset(broken))
    return Declared(vocabulary, {})


def collect_project(
    directory: Path, found: list[Problem], warned: list[Problem] | None = None
) -> tuple[Project | None, Declared | None]:
    """Read what can be read; problems go to ``found``. Without sound declarations only the form of files is checked.

    With a list for what is ``warned`` of, pictures are decoded.
    """
    if not is_folder(directory):
        found.append(Problem(directory, None, "is not a folder"))
        return None, None
    loaded = load_document(directory / DOMAIN, directory, DomainDoc, found)
    declared = build_declared(*loaded) if loaded else None
    folders = named_folders(directory / DEMOS, DEMO, found)
    if not folders:
        found.append(Problem(directory / DEMOS, None, f"holds no demonstration; add {DEMOS}/<name>/{DEMO}"))
    demos = [_read_demo(folder, directory, declared, found, warned) for folder in folders]
    if loaded is None or declared is None:
        return None, None
    doc = loaded[1]
    simulator = doc.simulator.model_dump() if doc.simulator else None
    asking = {name: values for name, values in (("proposal", doc.proposal), ("labels", doc.labels)) if values}
    return Project(declared.vocabulary, tuple(d for d in demos if d), doc.learning, simulator, asking), declared


def _read_demo(
    folder: Path, root: Path, declared: Declared | None, found: list[Problem], warned: list[Problem] | None
) -> Demo | None:
    before = len(found)
    loaded = load_document(folder / DEMO, root, DemoDoc, found)
    if loaded is None or declared is None:
        return None
    sheet, doc = loaded
    if not doc.actions:
        sheet.report(("actions",), "a demonstration needs at least one action")
    if not doc.goal:
        sheet.report(("goal",), "a demonstration needs a goal")
    if len(doc.states) != len(doc.actions) + 1:
        sheet.report(
            ("states",), f"{len(doc.actions)} actions need {len(doc.actions) + 1} states, found {len(doc.states)}"
        )
    scene = SceneReader(sheet, declared, root, warned)
    if not doc.objects:
        known = ", ".join(list(declared.objects)[:20])
        sheet.report(("objects",), f"to be filled in: the objects of this scene{f', of {known}' if known else ''}")
    objects = scene.objects(doc.objects)
    goals = scene.goals(("goal",), doc.goal) or ((),)
    actions = scene.actions(("actions",), doc.actions)
    images = folder / IMAGES
    states = tuple(scene.state(("states", t), state, images / str(t)) for t, state in enumerate(doc.states))
    check_image_folders(images, len(doc.states), found)
    if len(found) > before or scene.incomplete:
        return None
    check_goals(sheet, goals, states)
    check_features(sheet, actions, states)
    return Demo(folder.name, objects, states, actions, goals[0], goals[1:])


def collect_tasks(
    directory: Path, declared: Declared | None, found: list[Problem], warned: list[Problem] | None = None
) -> tuple[StoredTask, ...]:
    """Read the tasks that can be read; problems go to ``found``."""
    folders = named_folders(directory / TASKS, TASK, found)
    tasks = [read_one_task(folder, directory, declared, found, warned) for folder in folders]
    return tuple(task for task in tasks if task)


def read_one_task(
    folder: Path, root: Path, declared: Declared | None, found: list[Problem], warned: list[Problem] | None
) -> StoredTask | None:
    """The task in ``folder``; files must lie inside ``root``. None, with problems in ``found``, if it is unsound."""
    simulator = _read_simulator(folder / SIMULATOR, root, found)
    loaded = load_document(folder / TASK, root, TaskDoc, found)
    if loaded is None or declared is None:
        return None
    sheet, doc = loaded
    if not doc.goal:
        sheet.report(("goal",), "a task needs a goal")
    scene = SceneReader(sheet, declared, root, warned)
    objects = scene.objects(doc.objects)
    goal, *others = scene.goals(("goal",), doc.goal) or ((),)
    images = folder / IMAGES
    initial = scene.state(("state",), doc.state, images / "0")
    check_image_folders(images, 1, found)
    return StoredTask(Task(folder.name, objects, initial, goal, tuple(others)), simulator, folder / SIMULATOR)


def _read_simulator(file: Path, root: Path, found: list[Problem]) -> Mapping[str, Any] | None:
    message = refusal(file, root)
    if message == MISSING:
        return None
    if message:
        found.append(Problem(file, None, message))
        return None
    try:
        data = json.loads(file.read_text(encoding="utf-8"), parse_constant=_refuse_constant)
    except json.JSONDecodeError as error:
        found.append(Problem(file, error.lineno, f"not valid JSON: {error.msg}"))
    except (OSError, ValueError, RecursionError) as error:
        found.append(Problem(file, None, f"cannot be read as JSON ({error})"))
    else:
        if isinstance(data, dict):
            return data
        found.append(Problem(file, 1, "expected a JSON object { ... }"))
    return None


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a JSON number")
