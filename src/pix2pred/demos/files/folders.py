"""What lies where in a project folder, and what is safe to open.

::

    DIR/domain.yaml
    DIR/demos/<name>/demo.yaml   DIR/demos/<name>/images/<t>/<camera>.png
    DIR/tasks/<name>/task.yaml   DIR/tasks/<name>/images/0/<camera>.png   [DIR/tasks/<name>/simulator.json]
"""

from __future__ import annotations

import re
from pathlib import Path

from pix2pred.demos.files.problems import FolderError, Problem
from pix2pred.demos.files.yaml_lines import MAX_BYTES

DOMAIN, DEMOS, TASKS = "domain.yaml", "demos", "tasks"
DEMO, TASK, IMAGES, SIMULATOR = "demo.yaml", "task.yaml", "images", "simulator.json"

FOLDER_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_\-.]{0,99}\Z")
"""Names of demonstrations and tasks: they are names of folders, on every file system."""


MISSING = "does not exist"


LFS_POINTER = "is a pointer of Git LFS, not the file itself; fetch it with: git lfs pull"
_LFS_START, _LFS_SIZE = b"version https://git-lfs.github.com/spec/", 1024
"""How a pointer begins, and the size that none exceeds (Git LFS specification)."""


def _is_lfs_pointer(path: Path) -> bool:
    if path.stat().st_size > _LFS_SIZE:
        return False
    with path.open("rb") as file:
        return file.read(len(_LFS_START)) == _LFS_START


def is_folder(path: Path) -> bool:
    """Whether ``path`` is a folder one may look into."""
    try:
        return path.is_dir()
    except OSError:
        return False


def natural(name: str) -> tuple[list[str | int], str]:
    """Sort key that puts ``demo-2`` before ``demo-10``."""
    return [int(part) if part.isdecimal() else part for part in re.split(r"(\d+)", name)], name


def refusal(path: Path, root: Path, what: str = "project folder") -> str | None:
    """Why ``path`` is not opened; None for a regular file inside ``root``, which people call the ``what``."""
    try:
        real = path.resolve(strict=True)
        if not real.is_relative_to(root.resolve()):
            return f"leads outside the {what}; copy the file into it"
        if not real.is_file():
            return "is not a regular file"
        return LFS_POINTER if _is_lfs_pointer(real) else None
    except FileNotFoundError:
        return MISSING
    except (OSError, RuntimeError):  # RuntimeError: a loop of links, before Python 3.13
        return "cannot be opened"


def text_of(file: Path) -> str:
    """What stands in a text file that a person wrote. Raises ``FolderError``, for more than ``MAX_BYTES`` too."""
    try:
        content = file.read_bytes()
        if len(content) > MAX_BYTES:
            raise FolderError.about(file, f"has {len(content)} bytes; more than {MAX_BYTES} are not read")
        return content.decode("utf-8-sig")
    except OSError as error:
        raise FolderError.about(file, f"cannot be read ({error.strerror})") from error
    except UnicodeDecodeError as error:
        raise FolderError.about(file, "is not UTF-8 text; save it with the encoding UTF-8") from error


def entries(folder: Path, found: list[Problem]) -> list[Path]:
    """What is in ``folder`` in natural order, without hidden files; nothing when there is no such folder."""
    try:
        return sorted((p for p in folder.iterdir() if not p.name.startswith(".")), key=lambda p: natural(p.name))
    except FileNotFoundError:
        return []
    except OSError as error:
        found.append(Problem(folder, None, f"cannot be listed ({error.strerror})"))
        return []


def named_folders(parent: Path, sheet: str, found: list[Problem]) -> list[Path]:
    """The folders of demonstrations or tasks; each must hold a file called ``sheet``."""
    folders = []
    for path in entries(parent, found):
        if not is_folder(path):
            if path.suffix in (".yaml", ".yml"):
                found.append(Problem(path, None, f"is not read here; put it at {parent.name}/<name>/{sheet}"))
        elif not FOLDER_NAME.match(path.name):
            found.append(Problem(parent, None, f"folder {path.name!r}: use letters, digits, '_', '-' and '.' only"))
        else:
            folders.append(path)
    return folders
