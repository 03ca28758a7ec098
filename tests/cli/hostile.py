"""What the hostile tests of the command line share: changing projects, judging messages, comparing folders."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import cli.hostile_lamps as lamps
from command_line import Ran
from pix2pred.domains.burger import BurgerDomain
from pix2pred.registry import Registry
from pix2pred.structs import Demo
from pix2pred.structs.environment import Domain, SimulatedTask
from pix2pred.vlm import Request

HELPER = Path(lamps.__file__)
sees: Callable[[Request], str] = lamps.sees
Model = Callable[..., Any]


def always(text: str) -> Callable[[Request], str]:
    return lambda request: text


def edit(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))


def edit_demos(data: Path, old: str, new: str) -> None:
    for file in data.glob("demos/*/demo.yaml"):
        edit(file, old, new)


def add_predicate(data: Path, line: str) -> None:
    edit(data / "domain.yaml", "source: human}\n", f"source: human}}\n- {line}\n")


def said(ran: Ran) -> str:
    """The message without progress bars, on one line."""
    bar = re.compile(r"━|\d+/\d+ +\d+:\d\d:\d\d")
    return " ".join(line.strip() for line in ran.err.splitlines() if not bar.search(line)).strip()


def tree(folder: Path) -> dict[str, bytes]:
    return {
        str(p.relative_to(folder)): p.read_bytes()
        for p in sorted(folder.rglob("*"))
        if p.is_file() and p.name not in ("timings.json", "report.html", ".lock")
    }


def refused(ran: Ran, *parts: object) -> None:
    """The command ended with exit code 2 and one short message that holds all ``parts``."""
    message = said(ran)
    assert ran.code == 2, (ran.code, message)
    assert "Traceback" not in ran.err and message.startswith("pix2pred: ") and len(message) < 4000, message
    for part in parts:
        assert str(part) in message, (part, message)


def whole(folder: Path) -> None:
    """Every JSON file is complete. Hidden files are what a killed process had begun; the next run removes them."""
    for path in folder.rglob("*.json"):
        if not path.name.startswith("."):
            json.loads(path.read_text())


def start(seconds: float, *args: object, **options: Any) -> subprocess.Popen[str]:
    """The command line in another process, with the lamps' model, which takes ``seconds`` an answer."""
    command = [sys.executable, str(HELPER), str(seconds), *map(str, args)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)


def finish(process: subprocess.Popen[str]) -> Ran:
    out, err = process.communicate(timeout=300)
    return Ran(process.returncode, out, err)


class FailsAt:
    """Answers honestly until the ``n``-th query, which raises."""

    def __init__(self, n: int, error: BaseException) -> None:
        self.left, self.error = n, error

    def __call__(self, request: Request) -> str:
        self.left -= 1
        if self.left <= 0:
            raise self.error
        return sees(request)


class EmptyBurger(BurgerDomain):
    """The burger domain without demonstrations and tasks: nothing is drawn."""

    def demonstrations(self, family: str, seed: int) -> Sequence[Demo]:
        return ()

    def tasks(self, family: str, seed: int, count: int = 10) -> Sequence[SimulatedTask]:
        return ()


class NothingDrawn(Registry):
    """A registry with that domain alone."""

    def domain(self, name: str) -> Domain:
        return EmptyBurger()
