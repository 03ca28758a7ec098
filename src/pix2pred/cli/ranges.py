"""What options may be: ranges of numbers, and places to write to. Everything is checked before any work begins."""

from __future__ import annotations

import math
import os
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

Validator = Callable[[Any, Any], None]

MOST_WORKERS = 1024
"""Processes or threads at once; beyond it a mistake is likelier than a machine."""


def between(low: float, high: float = math.inf) -> Validator:
    """A finite number from ``low`` to ``high``, both included; no option at all is fine."""

    def check(kind: Any, value: Any) -> None:
        if value is None:
            return
        if not math.isfinite(value) or not low <= value <= high:
            raise ValueError(f"must be from {low:g} to {high:g}" if high < math.inf else f"must be {low:g} or more")

    return check


NOT_NEGATIVE = between(0)
POSITIVE = between(1)
SHARE = between(0, 1)
PORT = between(0, 65_535)
WORKERS = between(1, MOST_WORKERS)
DOLLARS = between(0, 1_000_000)


def output_file(kind: Any, value: Path | None) -> None:
    """Raise ``ValueError`` unless a file can be written at ``value``."""
    if value is None:
        return
    if value.name in ("", "..") or value.is_dir():
        raise ValueError("name a file, not a folder")
    _in_writable_folder(value)


def output_folder(kind: Any, value: Path | None) -> None:
    """Raise ``ValueError`` unless ``value`` is a folder, or can become one, that may be written to."""
    if value is None:
        return
    if value == Path():
        raise ValueError("name a folder of its own, not the present one")
    if value.is_dir():
        return  # what it may hold is the job's to say
    if value.exists() or value.is_symlink():
        raise ValueError(f"{value}: is a file; name a folder")
    _in_writable_folder(value)


def _in_writable_folder(path: Path) -> None:
    parent = next(p for p in path.absolute().parents if p.exists() or p.is_symlink())
    if not parent.is_dir():
        raise ValueError(f"{parent}: is a file; {path} cannot lie below it")
    if not os.access(parent, os.W_OK):
        raise ValueError(f"{parent}: may not be written to")


def quoted(path: Path | str) -> str:
    """``path`` as it can be typed into a shell."""
    return shlex.quote(str(path))
