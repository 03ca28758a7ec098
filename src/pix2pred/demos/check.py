"""Everything that is wrong with a project folder, and what will hurt later."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pix2pred.demos.cautions import cautions
from pix2pred.demos.files.folders import is_folder
from pix2pred.demos.files.problems import Problem, in_reading_order
from pix2pred.demos.read import Project, collect_project, collect_tasks


@dataclass(frozen=True, slots=True)
class Inspection:
    """What was found: ``problems`` must be put right, ``warnings`` may. ``project`` is None while there are problems.

    What the demonstrations lack as a whole is warned of only when all of them can be read.
    """

    problems: tuple[Problem, ...]
    warnings: tuple[Problem, ...]
    project: Project | None


def inspect_project(directory: Path) -> Inspection:
    """Look at declarations, demonstrations and tasks, pictures decoded. Never raises on bad content."""
    found: list[Problem] = []
    warned: list[Problem] = []
    project, declared = collect_project(directory, found, warned)
    tasks = collect_tasks(directory, declared, found, warned) if is_folder(directory) else ()
    if found or project is None or declared is None:
        return Inspection(tuple(in_reading_order(found)), tuple(in_reading_order(warned)), None)
    warned[:0] = cautions(directory, project, declared, tasks)
    return Inspection((), tuple(in_reading_order(warned)), project)


def check_project(directory: Path) -> list[Problem]:
    """Every problem in declarations, demonstrations and tasks, pictures decoded. Never raises on bad content."""
    return list(inspect_project(directory).problems)
