"""Writing project folders: the same content always gives the same bytes, and what is written can be read."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from pix2pred.demos.files.documents import VERSION, DemoDoc, DomainDoc, TaskDoc
from pix2pred.demos.files.folders import DEMO, DEMOS, DOMAIN, FOLDER_NAME, IMAGES, SIMULATOR, TASK, TASKS, natural
from pix2pred.demos.files.problems import FolderError
from pix2pred.demos.files.staging import blamed, move_in, staged
from pix2pred.demos.files.yaml_lines import YamlError, parse_yaml
from pix2pred.demos.files.yaml_text import dump_yaml
from pix2pred.demos.pictures import JPEG_START, PNG_START
from pix2pred.demos.read import read_project, read_tasks
from pix2pred.structs import Action, Demo, Image, Object, State, Vocabulary
from pix2pred.structs.environment import SimulatedTask
from pix2pred.structs.formats.writing import predicate_doc, skill_doc, type_doc
from pix2pred.structs.goals.words import shown
from pix2pred.structs.skills import FAILED


def write_project(
    directory: Path,
    vocabulary: Vocabulary,
    demos: Sequence[Demo],
    tasks: Sequence[SimulatedTask] = (),
    simulator: Mapping[str, str] | None = None,
    learning: Mapping[str, Any] | None = None,
    *,
    asking: Mapping[str, Mapping[str, Any]] | None = None,
    overwrite: bool = False,
) -> None:
    """Write a whole project, which appears at once or not at all.

    An existing project is replaced with ``overwrite``: its ``domain.yaml``, ``demos`` and ``tasks``, while other
    files in it stay. Any other folder with something in it is refused. Raises ``FolderError``, also for content that
    could not be read again.
    """
    directory = directory.absolute()
    _refuse_occupied(directory, overwrite=overwrite)
    _refuse_names(directory, "demonstration", [demo.name for demo in demos])
    _refuse_names(directory, "task", [task.task.name for task in tasks])
    with staged(directory) as stage:
        shared = _shared_objects([*(demo.objects for demo in demos), *(task.task.objects for task in tasks)])
        settings = {"learning": learning or {}} | dict(asking or {})
        _write_yaml(stage / DOMAIN, _domain_doc(vocabulary, shared.values(), simulator, settings))
        for demo in demos:
            _write_demo(stage / DEMOS / demo.name, demo, shared)
        for task in tasks:
            _write_task(stage / TASKS / task.task.name, task)
        with blamed(stage, directory):
            read_project(stage)
            read_tasks(stage, vocabulary)
        move_in(stage, directory, [DOMAIN, DEMOS, TASKS])


def write_task(directory: Path, vocabulary: Vocabulary, task: SimulatedTask, *, overwrite: bool = False) -> None:
    """Write ``directory/tasks/<name>``; the file carries its own objects and needs no ``domain.yaml``.

    Raises ``FolderError`` when the task exists already (unless ``overwrite``) or could not be read again.
    """
    directory = directory.absolute()
    name = task.task.name
    _refuse_names(directory, "task", [name])
    target = directory / TASKS / name
    if target.exists() and not overwrite:
        raise FolderError.about(target, "exists already; choose another name, or ask to overwrite it")
    with staged(directory) as stage:
        _write_task(stage / TASKS / name, task)
        with blamed(stage, directory):
            read_tasks(stage, vocabulary)
        (directory / TASKS).mkdir(parents=True, exist_ok=True)
        move_in(stage / TASKS, directory / TASKS, [name])


def _refuse_occupied(directory: Path, *, overwrite: bool) -> None:
    if directory.exists() and not directory.is_dir():
        raise FolderError.about(directory, "is a file; choose a folder")
    if not directory.is_dir() or not any(directory.iterdir()):
        return
    if not _is_project(directory):
        raise FolderError.about(directory, "holds other files and is no project; choose another folder")
    if not overwrite:
        raise FolderError.about(directory, "holds a project already; ask to overwrite it")


def _is_project(directory: Path) -> bool:
    try:
        data = parse_yaml((directory / DOMAIN).read_bytes()).data
    except (OSError, YamlError):
        return False
    return isinstance(data, dict) and data.get("format") == DomainDoc.FORMAT


def _refuse_names(directory: Path, kind: str, names: Sequence[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if not FOLDER_NAME.match(name):
            raise FolderError.about(
                directory, f"{kind} name {name!r} cannot name a folder: use letters, digits, '_', '-' and '.'"
            )
        if name.casefold() in seen:
            raise FolderError.about(directory, f"two {kind}s are named {name!r} (case does not count)")
        seen.add(name.casefold())


def _shared_objects(groups: Iterable[Sequence[Object]]) -> dict[str, Object]:
    """Objects that mean the same wherever they occur; only these are declared in ``domain.yaml``."""
    meanings: dict[str, set[Object]] = {}
    for objects in groups:
        for item in objects:
            meanings.setdefault(item.name, set()).add(item)
    return {name: next(iter(meanings[name])) for name in sorted(meanings, key=natural) if len(meanings[name]) == 1}


def _domain_doc(
    vocabulary: Vocabulary,
    objects: Iterable[Object],
    simulator: Mapping[str, str] | None,
    settings: Mapping[str, Mapping[str, Any]],
) -> dict[str, Any]:
    doc: dict[str, Any] = {"format": DomainDoc.FORMAT, "version": VERSION, "name": vocabulary.name}
    if simulator is not None:
        doc["simulator"] = dict(simulator)
    doc["types"] = [type_doc(t) for t in vocabulary.types]
    doc["objects"] = _objects_doc(objects)
    doc["skills"] = [skill_doc(s) for s in vocabulary.skills]
    doc["predicates"] = [predicate_doc(p) for p in vocabulary.initial]
    return doc | {section: dict(values) for section, values in settings.items() if values}


def _objects_doc(objects: Iterable[Object]) -> dict[str, Any]:
    return {o.name: {"type": o.type.name, "descriptor": o.descriptor} for o in objects}


def _write_demo(folder: Path, demo: Demo, shared: Mapping[str, Object]) -> None:
    listed = all(shared.get(o.name) == o for o in demo.objects)
    states = [write_state(folder / IMAGES / str(t), state, demo.objects) for t, state in enumerate(demo.states)]
    doc = {
        "format": DemoDoc.FORMAT,
        "version": VERSION,
        "objects": [o.name for o in demo.objects] if listed else _objects_doc(demo.objects),
        "goal": shown(demo.goals),
        "actions": [_action_text(action) for action in demo.actions],
        "states": states,
    }
    _write_yaml(folder / DEMO, doc)


def _write_task(folder: Path, simulated: SimulatedTask) -> None:
    task = simulated.task
    doc = {
        "format": TaskDoc.FORMAT,
        "version": VERSION,
        "objects": _objects_doc(task.objects),
        "goal": shown(task.goals),
        "state": write_state(folder / IMAGES / "0", task.initial, task.objects),
    }
    _write_yaml(folder / TASK, doc)
    text = json.dumps(simulated.simulator, indent=1, sort_keys=True, allow_nan=False)
    (folder / SIMULATOR).write_text(text + "\n", encoding="utf-8", newline="\n")


def write_state(images: Path, state: State, objects: Sequence[Object]) -> dict[str, Any]:
    """Write the pictures of ``state`` into the folder ``images``; returns the rest of it, as a file holds it."""
    doc: dict[str, Any] = {}
    if state.features:
        ordered = [o for o in objects if o in state.features]
        ordered += sorted(o for o in state.features if o not in objects)
        doc["features"] = {o.name: [_number(v) for v in state.features[o]] for o in ordered}
    doc["given"] = [str(atom) for atom in sorted(state.given)]
    rank = {o.name: i for i, o in enumerate(objects)}
    doc["pictures"] = {}
    for picture in state.pictures:
        _write_picture(images, picture.camera, picture.image)
        boxes = sorted(picture.boxes.items(), key=lambda item: (rank.get(item[0], len(rank)), item[0]))
        doc["pictures"][picture.camera] = {
            name: [_number(v) for v in (box.left, box.top, box.right, box.bottom)] for name, box in boxes
        }
    return doc


def _write_picture(images: Path, camera: str, image: Image) -> None:
    """PNG and JPEG are kept as they are; anything else becomes PNG."""
    if not FOLDER_NAME.match(camera):
        raise FolderError.about(images, f"camera name {camera!r} cannot name a file")
    encoded = image.encoded
    if not encoded.startswith((PNG_START, JPEG_START)):
        encoded = Image.from_pixels(image.pixels()).encoded
    images.mkdir(parents=True, exist_ok=True)
    (images / f"{camera}{'.jpg' if encoded.startswith(JPEG_START) else '.png'}").write_bytes(encoded)


def _number(value: float) -> int | float:
    """Whole numbers are written without a point."""
    value = float(value)
    return int(value) if value.is_integer() and abs(value) < 1e15 else value


def _action_text(action: Action) -> str:
    text = f"{action.skill.name}({', '.join(o.name for o in action.objects)})"
    text += f"[{', '.join(repr(_number(p)) for p in action.params)}]" if action.params else ""
    return f"{text} {FAILED}" if action.failed else text


def _write_yaml(file: Path, doc: Mapping[str, Any]) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(dump_yaml(doc), encoding="utf-8", newline="\n")
