"""Folders in the names of models (``replay:DIR``, ``mailbox:DIR``): kept so that a run works from anywhere.

A folder that was named relative to where the command ran is kept relative to the run folder, and moves with it. Runs of
before kept it as it was typed; where that leads nowhere from the run, it is tried from the present folder.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

_WITH_FOLDER = ("replay", "mailbox", "reader")
_CASCADE = "cascade:"
"""A reader's folder, a comma, and the name of another model, which may hold a folder as well."""


def kept(spec: str, run: Path) -> str:
    """``spec`` as ``config.yaml`` keeps it."""
    return _moved(spec, lambda folder: Path(os.path.relpath(Path(folder).resolve(), run.resolve())).as_posix())


def reached(spec: str, run: Path) -> str:
    """``spec``, which ``config.yaml`` of ``run`` kept, as it leads to the folder from here."""

    def from_here(folder: str) -> str:
        from_run = run / folder
        return folder if Path(folder).exists() and not from_run.exists() else str(from_run)

    return _moved(spec, from_here)


def same(one: str, other: str, run: Path) -> bool:
    """Whether two kept names lead to the same model and folder."""
    return one == other or _resolved(one, run) == _resolved(other, run)


def folder_of(spec: str) -> Path | None:
    """The folder that a name of a model holds, if it holds one; of a cascade that of its large model."""
    if spec.startswith(_CASCADE):
        return folder_of(spec.partition(",")[2])
    _, folder = _parts(spec)
    return Path(folder) if folder else None


def stores_of_pictures(run: Path, config: Mapping[str, Any]) -> tuple[Path, ...]:
    """Answer stores that may hold the pictures of a run with this configuration, the run itself last."""
    answers = config.get("answers")
    replayed = folder_of(reached(str(config.get("vlm", "")), run))
    return (*([Path(answers)] if answers else []), *([replayed] if replayed else []), run)


def _moved(spec: str, move: Callable[[str], str]) -> str:
    """``spec`` with every folder that is named relative to another one as ``move`` gives it."""
    if spec.startswith(_CASCADE):
        reader, _, model = spec.removeprefix(_CASCADE).partition(",")
        return f"{_CASCADE}{_moved(f'reader:{reader}', move).removeprefix('reader:')},{_moved(model, move)}"
    kind, folder = _parts(spec)
    return spec if not folder or Path(folder).expanduser().is_absolute() else f"{kind}:{move(folder)}"


def _resolved(spec: str, run: Path) -> tuple[str, Path | None]:
    folder = folder_of(reached(spec, run))
    return _parts(spec)[0], folder.resolve() if folder else None


def _parts(spec: str) -> tuple[str, str]:
    kind, _, rest = spec.partition(":")
    return (kind, rest) if kind in _WITH_FOLDER else (spec, "")
