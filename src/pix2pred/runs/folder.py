"""The folder of a run: locked while somebody works in it, claimed for one configuration, nothing half-written.

``layout`` lists the files. Every file is written under another name and renamed. All but timings, corrections and the
report have the same bytes for the same inputs.
"""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from pix2pred.demos import YamlError, parse_yaml
from pix2pred.runs import addresses
from pix2pred.runs.layout import CONFIG, CORRECTIONS, LOCK
from pix2pred.settings import default_of
from pix2pred.system.errors import Pix2predError
from pix2pred.system.files import read_regular, refuse_irregular, remove_abandoned, write_whole
from pix2pred.system.locks import LockedError, held


class RunFolderError(Pix2predError, ValueError):
    """A folder that cannot serve for this run; the message says why and what to do."""


_SHOWN = 5


@dataclass(frozen=True, slots=True)
class Difference:
    """What one of two configurations has that the other has not.

    ``key`` is dotted, as ``settings.labels.marks``; the values are ``then`` and ``now``, ``None`` where it is missing.
    """

    key: str
    then: Any
    now: Any

    def __str__(self) -> str:
        if self.key == "data":
            return "data: its demonstrations, pictures or declarations were others"
        return f"{self.key}: {_brief(self.then)} there, {_brief(self.now)} now"


def differences(then: Mapping[str, Any], now: Mapping[str, Any], prefix: str = "") -> list[Difference]:
    """What differs between two configurations, key by key; what one of them lacks is None."""
    found = []
    for key in dict.fromkeys([*then, *now]):
        a, b = then.get(key), now.get(key)
        if isinstance(a, dict) and isinstance(b, dict):
            found += differences(a, b, f"{prefix}{key}.")
        elif a != b:
            found.append(Difference(f"{prefix}{key}", a, b))
    return found


def _came_later(difference: Difference) -> bool:
    """Whether it is a setting that did not exist yet, and has its default now."""
    section, _, key = difference.key.partition(".")
    return section == "settings" and difference.then is None and difference.now == default_of(key)


def _brief(value: Any) -> str:
    text = "nothing" if value is None else str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


class RunFolder:
    """A run's folder. ``name`` arguments are paths inside it."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @contextmanager
    def locked(self) -> Iterator[RunFolder]:
        """Hold the folder for this process; what a killed one had begun to write is removed.

        Raises ``RunFolderError`` when another process works in it.
        """
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise RunFolderError(f"{self.path}: cannot be used as a run folder ({error.strerror})") from error
        path = self.path / LOCK
        is_new = not path.exists()
        with ExitStack() as stack:
            try:
                refuse_irregular(self.path / CORRECTIONS)
                stack.enter_context(held(path, wait=False))
            except LockedError as error:
                raise RunFolderError(f"{self.path}: another process is working in this run folder") from error
            except OSError as error:
                raise RunFolderError(f"{error.filename}: {error.strerror}") from error
            remove_abandoned(self.path)
            try:
                yield self
            except RunFolderError:
                if is_new:  # refused: leave the folder as it was
                    with suppress(OSError):  # Windows removes no open file, but its lock removes itself
                        path.unlink()
                raise

    def claim(self, config: Mapping[str, Any]) -> None:
        """Record ``config``, or check that the folder was made with the same one and can be resumed."""
        text = yaml.safe_dump(dict(config), sort_keys=True, allow_unicode=True)
        path = self.path / CONFIG
        if not path.exists():
            foreign = [p.name for p in self.path.iterdir() if p.name != LOCK and not p.name.startswith(".config.yaml.")]
            if foreign:
                raise RunFolderError(f"{self.path}: is not a run folder and not empty ({sorted(foreign)[0]} is in it)")
            self.write(CONFIG, text)
            return
        found = self.config()
        different = [
            d for d in differences(found, parse_yaml(text.encode()).data) if not (self._same_model(d) or _came_later(d))
        ]
        if different:
            keys = sorted({d.key.partition(".")[0] for d in different})
            listed = "; ".join(str(d) for d in different[:_SHOWN]) + ("; ..." if len(different) > _SHOWN else "")
            raise RunFolderError(
                f"{self.path}: holds a run with another {', '.join(keys)} ({listed}). Choose another folder with "
                f"--out (with --answers {shlex.quote(str(self.path))} what was answered here is not asked). To start "
                "over in this folder, delete it"
            )

    def _same_model(self, difference: Difference) -> bool:
        """Whether ``--vlm`` merely names the same folder in another way."""
        return difference.key == "vlm" and addresses.same(str(difference.then), str(difference.now), self.path)

    def write(self, name: str, text: str) -> Path:
        """Write a text file, which appears complete or not at all."""
        return self.write_bytes(name, text.encode())

    def write_bytes(self, name: str, content: bytes) -> Path:
        """Write a file, which appears complete or not at all."""
        path = self.path / name
        write_whole(path, content)
        return path

    def write_json(self, name: str, data: Any) -> Path:
        """Write a JSON file."""
        return self.write(name, json.dumps(data, indent=1) + "\n")

    def config(self) -> dict[str, Any]:
        """What the run was made with. Raises ``RunFolderError`` when the folder holds no run."""
        path = self.path / CONFIG
        if not path.is_file():
            raise RunFolderError(f"{self.path}: holds no run (no config.yaml); make one with 'pix2pred learn'")
        try:
            config = parse_yaml(read_regular(path)).data
        except YamlError as error:
            raise RunFolderError(f"{path}: is damaged ({' '.join(str(error).split())[:200]})") from error
        if not isinstance(config, dict):
            raise RunFolderError(f"{path}: is damaged (not a mapping); delete the folder to start over")
        return config
