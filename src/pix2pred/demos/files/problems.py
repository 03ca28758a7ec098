"""What can be wrong with a folder, and where."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pix2pred.system.errors import Pix2predError


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing to put right: the file, the line (None when it concerns the file as a whole), and what to do."""

    file: Path
    line: int | None
    message: str

    def __str__(self) -> str:
        """``file:line: message``."""
        return self.told()

    def told(self, kind: str = "") -> str:
        """``file:line: kind: message``."""
        where = self.file if self.line is None else f"{self.file}:{self.line}"
        return f"{where}: {kind}{': ' if kind else ''}{self.message}"


def in_reading_order(found: Sequence[Problem]) -> list[Problem]:
    """Files in the order they were read, and from top to bottom in each."""
    files = {file: rank for rank, file in reversed(list(enumerate(p.file for p in found)))}
    return sorted(found, key=lambda p: (files[p.file], p.line or 0))


class FolderError(Pix2predError, ValueError):
    """A folder that cannot be used as it is; ``problems`` says everything that is wrong with it."""

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))

    @classmethod
    def about(cls, file: Path, message: str) -> FolderError:
        """The error with one problem, which concerns ``file`` as a whole."""
        return cls([Problem(file, None, message)])
