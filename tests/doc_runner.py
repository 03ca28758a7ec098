"""Follows a page of the docs to the letter: saves its files, runs its commands, and compares what they print.

A fenced block after a line that ends in "`NAME`:" with the word "Save" or "save" in it is a file. A block ``console``
holds commands after ``$ `` (ending in `` \\`` they go on in the next line), each followed by all it prints on stdout,
or on stderr when it fails. A line ``...`` stands for any number of lines. ``pix2pred`` runs in this process, unless a
command is more than one program; a command that ends in ``&`` runs beside the others until the page ends.
"""

from __future__ import annotations

import _thread
import re
import shlex
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import pytest

from command_line import Ran
from pix2pred.cli.app import run

_FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_SAVED = re.compile(r"\b[Ss]ave\b.*`([\w./-]+)`[^`]*:\s*$", re.DOTALL)

ReadOutput = Callable[[], tuple[str, str]]


@dataclass(frozen=True)
class Command:
    text: str
    expected: tuple[str, ...]


@dataclass(frozen=True)
class SavedFile:
    name: str
    content: str


def parts(page: str) -> Iterator[Command | SavedFile]:
    """The files and commands of a page, in order."""
    end = 0
    for fence in _FENCE.finditer(page):
        before = page[end : fence.start()].rstrip().rpartition("\n\n")[2]
        end = fence.end()
        if fence[1] == "console":
            yield from _commands(fence[2])
        elif saved := _SAVED.search(before):
            yield SavedFile(saved[1], fence[2])


def _commands(block: str) -> Iterator[Command]:
    for piece in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
        text, _, output = re.sub(r" \\\n\s*", " ", piece).partition("\n")
        lines = [line.rstrip() for line in output.rstrip("\n").splitlines()]
        yield Command(text, tuple(line for line in lines if line))


def matches(expected: tuple[str, ...], printed: list[str]) -> bool:
    """Whether ``printed`` is what is expected, ``...`` standing for any lines."""
    if not expected:
        return not printed
    if expected[0] == "...":
        return any(matches(expected[1:], printed[i:]) for i in range(len(printed) + 1))
    return bool(printed) and printed[0] == expected[0] and matches(expected[1:], printed[1:])


@dataclass
class Follower:
    """Runs commands in the current folder; as a context manager it ends what runs in the background."""

    read: ReadOutput
    background: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for process in self.background:
            process.kill()
            process.wait()

    def follow(self, page: str) -> int:
        """Do all that the page says; gives the number of commands."""
        count = 0
        for part in parts(page):
            if isinstance(part, SavedFile):
                Path(part.name).parent.mkdir(parents=True, exist_ok=True)
                Path(part.name).write_text(part.content)
                continue
            count += 1
            ran = self._run(part.text)
            printed = [line.rstrip() for line in (ran.out if ran.code in (0, 1) else ran.out + ran.err).splitlines()]
            printed = [line for line in printed if line]
            assert matches(part.expected, printed), f"$ {part.text}\n" + "\n".join(printed) + f"\n--- stderr\n{ran.err}"
        return count

    def _run(self, text: str) -> Ran:
        if text.endswith("&"):
            words = [sys.executable if w == "python" else w for w in shlex.split(text.removesuffix("&"))]
            self.background.append(process := subprocess.Popen(words))
            threading.Thread(target=self._watch, args=(process,), daemon=True).start()
            return Ran(0, "", "")
        if text.startswith("pix2pred ") and not re.search(r"[|;>]", text):
            return self._here(text)
        command = re.sub(r"^python ", f"{shlex.quote(sys.executable)} ", text)
        done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
        return Ran(done.returncode, done.stdout, done.stderr)

    def _watch(self, process: subprocess.Popen[bytes]) -> None:
        """End a command that waits for a background process which has failed."""
        if process.wait() > 0:
            _thread.interrupt_main()

    def _here(self, text: str) -> Ran:
        text, _, source = text.partition("<")
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(sys, "stdin", StringIO(Path(source.strip()).read_text() if source else ""))
            code = run(shlex.split(text)[1:])
        return Ran(code, *self.read())


def defined_in_extending(name: str) -> Any:
    """The class or function called ``name`` that an example of docs/extending.md defines."""
    page = Path(__file__).parents[1] / "docs" / "extending.md"
    blocks = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    (code,) = [block for block in blocks if re.search(rf"^(class|def) {name}\b", block, re.MULTILINE)]
    names: dict[str, Any] = {}
    exec(code, names)  # the page's own code
    return names[name]
