"""Several project folders as one: their demonstrations together, if they speak of the same things."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from pix2pred.demos.files.problems import FolderError, Problem
from pix2pred.demos.read import Project


def join_projects(folders: Sequence[Path], projects: Sequence[Project]) -> Project:
    """The demonstrations of all ``projects``, which were read from ``folders``, under the first one's declarations.

    Demonstrations of the same name are told apart by the name of their folder. Raises ``FolderError`` unless all
    declare the same types, skills and predicates, and the same settings for learning.
    """
    first = projects[0]
    problems = []
    for folder, other in zip(folders[1:], projects[1:], strict=True):
        ours, theirs = first.vocabulary, other.vocabulary
        for what in ("types", "skills", "initial"):
            if sorted(map(repr, getattr(ours, what))) != sorted(map(repr, getattr(theirs, what))):
                name = "predicates" if what == "initial" else what
                problems.append(
                    Problem(folder / "domain.yaml", None, f"declares other {name} than {folders[0] / 'domain.yaml'}")
                )
        if other.sections != first.sections:
            said = f"has other settings than {folders[0] / 'domain.yaml'}; give both the same"
            problems.append(Problem(folder / "domain.yaml", None, said))
    if problems:
        raise FolderError(problems)
    counts = Counter(demo.name for project in projects for demo in project.demos)
    demos = [
        demo if counts[demo.name] == 1 else replace(demo, name=f"{folder.resolve().name}-{demo.name}")
        for folder, project in zip(folders, projects, strict=True)
        for demo in project.demos
    ]
    twice = [name for name, count in Counter(demo.name for demo in demos).items() if count > 1]
    if twice:
        raise FolderError.about(folders[-1], f"two demonstrations are called {twice[0]!r}; rename one folder")
    return replace(first, demos=tuple(demos))
