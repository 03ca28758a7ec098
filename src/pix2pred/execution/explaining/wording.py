"""A step of a plan as one says it to a person."""

from __future__ import annotations

import re

from pix2pred.structs import GroundOperator, Object

_SEAM = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|_+")


def in_words(step: GroundOperator) -> str:
    """``Put on: small blue cup (cup1), saucer``: the skill's name as words, and what its objects look like."""
    name = " ".join(_SEAM.sub(" ", step.operator.skill.name).split())
    things = ", ".join(_called(o) for o in step.skill_objects)
    words = name[:1].upper() + name[1:].lower()
    return f"{words}: {things}" if things else words


def _called(thing: Object) -> str:
    spoken = thing.descriptor.strip()
    return thing.name if spoken in ("", thing.name) else f"{spoken} ({thing.name})"
