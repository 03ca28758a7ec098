"""Everything that is wrong with a project folder: what reading finds, and what the pictures show."""

from __future__ import annotations

from pathlib import Path

from pix2pred.demos.folders import is_folder
from pix2pred.demos.problems import Problem, in_reading_order
from pix2pred.demos.read import collect_project, collect_tasks


def check_project(directory: Path) -> list[Problem]:
    """Every problem in declarations, demonstrations and tasks, pictures decoded. Never raises on bad content."""
    found: list[Problem] = []
    _, declared = collect_project(directory, found, decode=True)
    if is_folder(directory):
        collect_tasks(directory, declared, found, decode=True)
    return in_reading_order(found)
