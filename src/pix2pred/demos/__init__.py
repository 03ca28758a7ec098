"""Demonstrations and tasks on disk: a folder a person can make by hand, its checks, reading and writing."""

from pix2pred.demos.check import check_project
from pix2pred.demos.digest import project_digest
from pix2pred.demos.documents import json_schemas
from pix2pred.demos.problems import FolderError, Problem
from pix2pred.demos.read import Project, StoredTask, read_project, read_tasks
from pix2pred.demos.write import write_project, write_task

__all__ = [
    "FolderError",
    "Problem",
    "Project",
    "StoredTask",
    "check_project",
    "json_schemas",
    "project_digest",
    "read_project",
    "read_tasks",
    "write_project",
    "write_task",
]
