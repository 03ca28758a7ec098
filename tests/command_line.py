"""What a call of the command line gave, for tests."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pix2pred.cli.app import run
from pix2pred.registry import REGISTRY, Registry


@dataclass(frozen=True)
class Ran:
    code: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        parsed: dict[str, Any] = json.loads(self.out.strip().splitlines()[-1])
        return parsed


@dataclass
class Cli:
    """The command line in this process; ``registry`` is where it looks names up."""

    read: Callable[[], tuple[str, str]]
    registry: Registry = REGISTRY

    def __call__(self, *args: object) -> Ran:
        code = run([str(a) for a in args], self.registry)
        return Ran(code, *self.read())
