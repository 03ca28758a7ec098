"""What the labels of a run rest on: pictures, boxes, crops and the model's explanations (format pix2pred-evidence).

Pictures are named by the digest of their pixels, as in the answer store. Explanations repeat, so each is stored once.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from pydantic import ValidationError

from pix2pred.images import skill_crop
from pix2pred.predicates.initial import is_asked
from pix2pred.predicates.labelling.explanations import explanations
from pix2pred.predicates.labelling.table import Labelling
from pix2pred.predicates.prompt import atom_text
from pix2pred.structs import Box, Demo
from pix2pred.structs.formats.documents import Document
from pix2pred.system.errors import Pix2predError, first_fault
from pix2pred.system.files import read_regular

EVIDENCE = "labels/evidence.json"
"""Where a run keeps it."""

Corners = tuple[float, float, float, float]
"""left, top, right, bottom in the picture's pixels; right and bottom are exclusive."""


class EvidenceError(Pix2predError, ValueError):
    """A file that is not evidence of a version this program reads."""


class PictureDoc(Document):
    """A camera's picture of a state; ``crop`` is the part the skill before was about."""

    camera: str
    digest: str
    size: tuple[int, int]
    boxes: dict[str, Corners]
    crop: Corners | None


class DemoEvidence(Document):
    """Pictures per state, and per atom and state the number of an explanation (-1: none)."""

    name: str
    descriptors: dict[str, str]
    states: tuple[tuple[PictureDoc, ...], ...]
    why: dict[str, tuple[int, ...]]


class Evidence(Document):
    """The whole file."""

    format: Literal["pix2pred-evidence"]
    version: Literal[1]
    explanations: tuple[str, ...]
    demos: tuple[DemoEvidence, ...]


def dump_evidence(demos: Sequence[Demo], labelling: Labelling) -> str:
    """The JSON text of the evidence behind ``labelling``; equal inputs give equal text."""
    numbers: dict[str, int] = {}
    docs = [
        {
            "name": demo.name,
            "descriptors": {o.name: o.descriptor or o.name for o in sorted(demo.objects)},
            "states": [_pictures(demo, t) for t in range(len(demo.states))],
            "why": _why(labelling, d, numbers),
        }
        for d, demo in enumerate(demos)
    ]
    head = {"format": "pix2pred-evidence", "version": 1, "explanations": list(numbers)}
    rows = ",\n".join(json.dumps(doc) for doc in docs)
    return json.dumps(head, indent=1)[:-2] + f',\n "demos": [\n{rows}\n ]\n}}\n'


def load_evidence(path: Path) -> Evidence:
    """Read evidence. Raises ``EvidenceError``."""
    try:
        return Evidence.model_validate(json.loads(read_regular(path)))
    except ValidationError as error:
        where, first = first_fault(error)
        raise EvidenceError(f"{path}: {where}: {first['msg']}; learn again to write it anew") from error
    except (OSError, ValueError, RecursionError) as error:
        raise EvidenceError(f"{path}: cannot be read as evidence ({error}); learn again to write it anew") from error


def _pictures(demo: Demo, t: int) -> list[dict[str, Any]]:
    docs = []
    for camera, picture in enumerate(demo.states[t].pictures):
        crop = None
        if t:
            names = [o.name for o in demo.actions[t - 1].objects]
            crop = skill_crop(demo.states[t - 1], demo.states[t], names, camera, picture.image.size)
        docs.append(
            {
                "camera": picture.camera,
                "digest": picture.image.digest,
                "size": list(picture.image.size),
                "boxes": {name: _corners(box) for name, box in sorted(picture.boxes.items())},
                "crop": _corners(crop) if crop else None,
            }
        )
    return docs


def _corners(box: Box) -> list[float]:
    return [round(float(x), 1) for x in (box.left, box.top, box.right, box.bottom)]


def _why(labelling: Labelling, d: int, numbers: dict[str, int]) -> dict[str, list[int]]:
    """Numbers of explanations by atom; new explanations are added to ``numbers``."""
    demo, answers = labelling.table.demos[d], labelling.answers[d]
    texts = {str(a): atom_text(a) for a in demo.atoms if is_asked(a)}
    found = [explanations(labels.text, list(texts.values())) for labels in answers]
    why: dict[str, list[int]] = {}
    for atom, text in texts.items():
        row = [numbers.setdefault(words[text], len(numbers)) if text in words else -1 for words in found]
        if any(number >= 0 for number in row):
            why[atom] = row
    return why
