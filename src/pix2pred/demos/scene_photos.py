"""One scene at a time: the folder of a single task, and photos taken while somebody executes a plan.

A photo may have a YAML file of the same name beside it (``0012.jpg``, ``0012.yaml``), a folder of photos, one per
camera, a file ``state.yaml``. It is written like a state of ``demo.yaml``, and may hold ``given``, ``features`` and,
for the cameras, boxes.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from pix2pred.demos.declared import Declared
from pix2pred.demos.files.documents import Sheet, StateDoc
from pix2pred.demos.files.folders import TASKS
from pix2pred.demos.files.problems import FolderError, Problem, in_reading_order
from pix2pred.demos.files.yaml_lines import LinedData, YamlError, parse_yaml
from pix2pred.demos.photos.copies import clean_copy
from pix2pred.demos.pictures import ENDINGS
from pix2pred.demos.read import StoredTask, declared_for_tasks, read_one_task
from pix2pred.demos.scenes import SceneReader
from pix2pred.structs import Image, Picture, PictureError, State, Task, Vocabulary
from pix2pred.system.errors import first_fault

STATE = "state.yaml"


@dataclass(frozen=True, slots=True)
class Photographed:
    """A state as photographed; ``told``: somebody listed its given atoms, so that those not listed do not hold."""

    state: State
    told: bool


def read_task(folder: Path, vocabulary: Vocabulary) -> StoredTask:
    """Read the folder of one task, with the objects that the ``domain.yaml`` of its project declares, if any.

    Raises ``FolderError`` with every problem found.
    """
    found: list[Problem] = []
    folder = folder.absolute()
    project = folder.parent.parent if folder.parent.name == TASKS else folder
    declared = declared_for_tasks(project, vocabulary, found)
    task = read_one_task(folder, folder, declared, found, warned=[])
    if task is not None and not task.task.initial.pictures:
        found.append(Problem(folder / "images" / "0", None, "holds no photo (PNG or JPEG) of the scene"))
    if found or task is None:
        raise FolderError(in_reading_order(found))
    return task


def read_photo(path: Path, task: Task, vocabulary: Vocabulary) -> Photographed:
    """Read a photo, or a folder with one photo per camera, of the objects of ``task``, without its metadata.

    Raises ``FolderError`` with every problem found, also when the cameras are not those of the task.
    """
    cameras = [picture.camera for picture in task.initial.pictures]
    files, beside = _files(path, cameras)
    found: list[Problem] = []
    images: dict[str, Image] = {}
    for camera, file in files.items():
        try:
            images[camera] = clean_copy(file, max_side=None)
        except PictureError as error:
            found.append(Problem(file, None, str(error).removeprefix(f"{file}: ")))
    sheet, doc = Sheet(path, LinedData({}, {(): 1}), found), StateDoc()
    if beside is not None:
        sheet, doc = _beside(beside, found)
    unknown = sorted(set(doc.pictures or ()) - set(cameras))
    if unknown:
        sheet.report(("pictures", unknown[0]), f"there is no camera {unknown[0]!r}; the task has {', '.join(cameras)}")
    scene = _scene(sheet, task, vocabulary)
    rest = scene.state((), doc.model_copy(update={"pictures": None}), path.parent / ".no pictures")
    boxes = {c: scene.boxes(("pictures", c), (doc.pictures or {}).get(c, {})) for c in cameras}
    if found:
        raise FolderError(in_reading_order(found))
    pictures = tuple(Picture(c, images[c], boxes[c]) for c in cameras)
    return Photographed(State(pictures, rest.features, rest.given), "given" in doc.model_fields_set)


def state_from_doc(data: Any, images: Path, task: Task, vocabulary: Vocabulary) -> State:
    """The state that ``write_state`` wrote to ``images`` and gave as ``data``. Raises ``FolderError``."""
    found: list[Problem] = []
    sheet = Sheet(images, LinedData(data, {(): 1}), found)
    try:
        doc = StateDoc.model_validate(data)
        state = _scene(sheet, task, vocabulary).state((), doc, images)
    except ValidationError as error:
        raise FolderError.about(images, f"what was kept of this state is damaged ({error})") from error
    if found:
        raise FolderError(found)
    return state


def _scene(sheet: Sheet, task: Task, vocabulary: Vocabulary) -> SceneReader:
    scene = SceneReader(sheet, Declared(vocabulary, {o.name: o for o in task.objects}), sheet.file.parent)
    scene.objects([o.name for o in task.objects])
    return scene


def _files(path: Path, cameras: list[str]) -> tuple[dict[str, Path], Path | None]:
    """The picture of every camera, and the YAML file beside them if there is one."""
    if path.is_dir():
        files = {}
        for camera in cameras:
            there = [path / f"{camera}{ending}" for ending in ENDINGS if (path / f"{camera}{ending}").is_file()]
            if len(there) != 1:
                what = (
                    f"holds {'no' if not there else 'more than one'} photo of camera {camera!r} ({camera}.png or .jpg)"
                )
                raise FolderError.about(path, what)
            files[camera] = there[0]
        beside = path / STATE
    elif len(cameras) > 1:
        raise FolderError.about(
            path, f"the task has the cameras {', '.join(cameras)}; give a folder with a photo of each, named after it"
        )
    elif not path.is_file():
        raise FolderError.about(path, "does not exist")
    else:
        files, beside = {cameras[0]: path}, path.with_suffix(".yaml")
    return files, beside if beside.is_file() else None


def _beside(path: Path, found: list[Problem]) -> tuple[Sheet, StateDoc]:
    try:
        lined = parse_yaml(path.read_bytes())
        return Sheet(path, lined, found), StateDoc.model_validate(lined.data or {})
    except YamlError as error:
        problem = Problem(path, error.line, error.message)
    except ValidationError as error:
        where, first = first_fault(error)
        problem = Problem(path, lined.line(first["loc"]), f"{where}: {first['msg']}")
    except OSError as error:
        problem = Problem(path, None, f"cannot be read ({error.strerror})")
    raise FolderError([problem])
