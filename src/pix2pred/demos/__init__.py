"""Demonstrations and tasks on disk: a folder a person can make by hand, its checks, reading, writing.

Other rooms import from here, from ``authoring`` (making a project) and from ``importers`` (bringing data in) alone.
"""

from pix2pred.demos.check import Inspection, check_project, inspect_project
from pix2pred.demos.digest import project_digest
from pix2pred.demos.files.folders import DOMAIN
from pix2pred.demos.files.problems import FolderError, Problem
from pix2pred.demos.files.schemas import json_schemas, write_schemas
from pix2pred.demos.files.yaml_lines import MAX_BYTES as MOST_YAML_BYTES
from pix2pred.demos.files.yaml_lines import YamlError, parse_yaml
from pix2pred.demos.join import join_projects
from pix2pred.demos.pictures import ENDINGS
from pix2pred.demos.read import Project, StoredTask, read_project, read_tasks
from pix2pred.demos.scene_photos import Photographed, read_photo, read_task, state_from_doc
from pix2pred.demos.write import write_project, write_state, write_task

__all__ = [
    "DOMAIN",
    "ENDINGS",
    "MOST_YAML_BYTES",
    "FolderError",
    "Inspection",
    "Photographed",
    "Problem",
    "Project",
    "StoredTask",
    "YamlError",
    "check_project",
    "inspect_project",
    "join_projects",
    "json_schemas",
    "parse_yaml",
    "project_digest",
    "read_photo",
    "read_project",
    "read_task",
    "read_tasks",
    "state_from_doc",
    "write_project",
    "write_schemas",
    "write_state",
    "write_task",
]
