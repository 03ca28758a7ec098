"""Files that appear complete or not at all, and files that are what they seem: no links, no pipes."""

from __future__ import annotations

import errno
import os
import re
import stat
import threading
import time
from contextlib import suppress
from pathlib import Path

_TEMPORARY = re.compile(r"^\..+\.(\d{1,9})\.\d+\.part$")
"""``.NAME.PROCESS.THREAD.part``: a file being written."""

_BEGAN = time.time()
"""When this process began, in seconds since 1970: what bears its number and is older is another's."""

_KINDS = {stat.S_ISLNK: "a link", stat.S_ISDIR: "a folder", stat.S_ISFIFO: "a pipe", stat.S_ISSOCK: "a socket"}


def write_whole(path: Path, content: bytes) -> None:
    """Write ``content`` under another name, then rename; a link at ``path`` is replaced, not followed.

    Raises ``OSError`` that names ``path``.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = _temporary(path)
    try:
        temporary.unlink(missing_ok=True)  # of a process that had our number and was killed
        with temporary.open("xb") as file:
            file.write(content)
        temporary.replace(path)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        temporary.unlink(missing_ok=True)


def check_writable(folder: Path) -> None:
    """Make ``folder`` where it is missing and raise ``OSError`` when no file can be written into it."""
    folder.mkdir(parents=True, exist_ok=True)
    probe = _temporary(folder / "probe")
    try:
        probe.write_bytes(b"")
    finally:
        probe.unlink(missing_ok=True)


def _temporary(path: Path) -> Path:
    """Where this thread writes what is to become ``path``."""
    return path.with_name(f".{path.name}.{os.getpid()}.{threading.get_ident()}.part")


def refuse_irregular(path: Path) -> None:
    """Raise ``OSError`` when there is something at ``path`` that is no regular file: a link, a folder, a pipe."""
    with suppress(FileNotFoundError):
        _check_regular(path, path.lstat().st_mode)


def read_regular(path: Path) -> bytes:
    """The content of the file at ``path``, reached through links too. Raises ``OSError`` for pipes and devices."""
    _check_regular(path, path.stat().st_mode)
    return path.read_bytes()


def _check_regular(path: Path, mode: int) -> None:
    if not stat.S_ISREG(mode):
        kind = next((word for is_kind, word in _KINDS.items() if is_kind(mode)), "a device")
        raise OSError(errno.EINVAL, f"is {kind}, where a plain file belongs; remove it", str(path))


def remove_abandoned(folder: Path) -> None:
    """Remove what processes that have ended had begun to write below ``folder``."""
    for path in folder.rglob(".*.part"):
        match = _TEMPORARY.match(path.name)
        if match and path.is_file() and _is_abandoned(path, int(match[1])):
            path.unlink(missing_ok=True)


def _is_abandoned(path: Path, process: int) -> bool:
    if process != os.getpid():
        return not _is_running(process)
    try:  # in a container, every process may have the number of the one before
        return path.stat().st_mtime < _BEGAN
    except FileNotFoundError:  # another thread has just finished it
        return False


def _is_running(process: int) -> bool:
    if os.name == "nt":
        return True  # there, asking with signal 0 would end the process
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
