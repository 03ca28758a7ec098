"""The card of what is shared on a hub: a README.md with the fields that hubs read, and what people need to know."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, Literal

import yaml
from jinja2 import Environment, StrictUndefined

from pix2pred import __version__
from pix2pred.demos import Project
from pix2pred.planning.pddl.write import write_domain
from pix2pred.structs import WorldModel

Licence = Literal[
    "apache-2.0", "mit", "bsd-3-clause", "cc0-1.0", "cc-by-4.0", "cc-by-sa-4.0", "cc-by-nc-4.0", "cc-by-nc-sa-4.0",
    "odc-by", "odbl", "other",
]  # fmt: skip
"""Identifiers that hubs know; ``other`` asks for a LICENSE file beside the card."""
_TAGS = ["pix2pred", "planning", "pddl", "symbolic-world-model"]


@dataclass(frozen=True, slots=True)
class SharedAs:
    """What the person who shares says: the licence by the name that hubs know and a title."""

    licence: Licence
    title: str


def project_card(project: Project, tasks: int, said: SharedAs) -> str:
    """The card of a project: demonstrations with pictures, declared names and settings."""
    front = {
        "license": said.licence,
        "pretty_name": said.title,
        "task_categories": ["robotics"],
        "tags": [*_TAGS, "imitation"],
        "size_categories": ["n<1K"],
    }
    return _card("card_project.md.j2", front, said, project=project, tasks=tasks)


def model_card(model: WorldModel, metrics: Mapping[str, Any], said: SharedAs) -> str:
    """The card of a learned world model."""
    front = {"license": said.licence, "library_name": "pix2pred", "tags": _TAGS, "pipeline_tag": "robotics"}
    return _card("card_model.md.j2", front, said, model=model, metrics=metrics, pddl=write_domain(model))


def _card(template: str, front: Mapping[str, Any], said: SharedAs, **given: Any) -> str:
    text = files("pix2pred.report").joinpath("templates", template).read_text(encoding="utf-8")
    plain = Environment(undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, autoescape=False)
    body = plain.from_string(text).render(said=said, version=__version__, **given)
    return f"---\n{yaml.safe_dump(dict(front), sort_keys=False, allow_unicode=True)}---\n\n{body.strip()}\n"
