"""PDDL files that a person names, read with errors that name the file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from pix2pred.cli.console import UsageError
from pix2pred.planning.pddl.syntax import PddlError

T = TypeVar("T")


def parsed(path: Path, read: Callable[[str], T]) -> T:
    """What ``read`` makes of the text of ``path``. Raises ``UsageError``."""
    try:
        return read(text_of(path))
    except PddlError as error:
        raise UsageError(f"{path}: {error}") from error


def text_of(path: Path) -> str:
    """The text of a file in UTF-8. Comments may be in any encoding. Raises ``UsageError``."""
    data = path.read_bytes()
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        lines = [line if _is_text(line) else line.partition(b";")[0] for line in data.split(b"\n")]
        for number, line in enumerate(lines, start=1):
            if not _is_text(line):
                where = f"{path}: line {number}"
                raise UsageError(f"{where}: this is no UTF-8 text; save the file as UTF-8") from error
        return b"\n".join(lines).decode("utf-8-sig")


def _is_text(line: bytes) -> bool:
    try:
        line.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True
