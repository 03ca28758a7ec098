"""What makes two projects the same data: everything learning reads, however it is stored."""

from __future__ import annotations

import hashlib
import json
from typing import Any

from pix2pred.demos.read import Project
from pix2pred.structs import Demo, State
from pix2pred.structs.formats.writing import vocabulary_doc


def project_digest(project: Project) -> str:
    """SHA-256 over vocabulary, demonstrations and decoded pixels; file names, compression and layout do not count.

    Neither do descriptions: a sentence reworded makes no other data, and projects without any keep their digest.
    Raises ``PictureError`` for pictures that cannot be read.
    """
    content = {
        "vocabulary": _undescribed(vocabulary_doc(project.vocabulary)),
        "demos": [_demo(d) for d in project.demos],
    }
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _undescribed(doc: dict[str, Any]) -> dict[str, Any]:
    described = ("types", "skills", "predicates")
    plain = {part: [{k: v for k, v in e.items() if k != "description"} for e in doc[part]] for part in described}
    return doc | plain


def _demo(demo: Demo) -> dict[str, object]:
    return {
        "name": demo.name,
        "objects": [[o.name, o.type.name, o.descriptor] for o in sorted(demo.objects)],
        "goal": sorted(map(str, demo.goal)),
        **({"alternatives": [sorted(map(str, goal)) for goal in demo.alternatives]} if demo.alternatives else {}),
        "actions": [str(a) for a in demo.actions],
        "states": [_state(s) for s in demo.states],
    }


def _state(state: State) -> dict[str, object]:
    return {
        "given": sorted(map(str, state.given)),
        "features": {o.name: list(map(float, values)) for o, values in sorted(state.features.items())},
        "pictures": [
            [p.camera, p.image.digest, {n: [b.left, b.top, b.right, b.bottom] for n, b in sorted(p.boxes.items())}]
            for p in state.pictures
        ],
    }
