"""Writing files that appear complete or not at all."""

from __future__ import annotations

import os
import re
import stat
import threading
from pathlib import Path

from pix2pred.system.errors import Pix2predError

_TEMPORARY = re.compile(r"^\..+\.(\d{1,9})\.\d+\.part$")
"""``.NAME.PROCESS.THREAD.part``: a file being written."""


class OddFileError(Pix2predError, OSError):
    """Something that is no plain file stands where one should be."""


def require_regular(path: Path) -> None:
    """Raise ``OddFileError`` if ``path`` is there and is no plain file: no link is followed, no pipe waited for."""
    try:
        mode = path.lstat().st_mode
    except FileNotFoundError:
        return
    if not stat.S_ISREG(mode):
        kind = "a link" if stat.S_ISLNK(mode) else "a folder" if stat.S_ISDIR(mode) else "no regular file"
        raise OddFileError(f"{path}: is {kind}, where a plain file should be; remove it")


def write_whole(path: Path, content: bytes) -> None:
    """Write ``content`` under another name, then rename. Raises ``OSError`` that names ``path``."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.{threading.get_ident()}.part")
    try:
        temporary.write_bytes(content)
        temporary.replace(path)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        temporary.unlink(missing_ok=True)


def remove_abandoned(folder: Path) -> None:
    """Remove what processes that have ended had begun to write below ``folder``."""
    for path in folder.rglob(".*.part"):
        match = _TEMPORARY.match(path.name)
        if match and path.is_file() and not _is_running(int(match[1])):
            path.unlink(missing_ok=True)


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
