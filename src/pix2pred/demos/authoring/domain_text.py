"""The text of a ``domain.yaml`` that explains itself."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pix2pred.demos.authoring.declaring import Declarations
from pix2pred.demos.files.documents import VERSION, DomainDoc
from pix2pred.demos.files.yaml_text import inline_yaml

_HEAD = """\
# What all demonstrations and tasks share. 'pix2pred check' on this folder says what is missing or wrong.
"""

_SECTIONS = {
    "types": """\
# The kinds of objects. A type may have a parent: what is said of the parent then holds for it too.
#   - {name: item}
#   - {name: cup, parent: item}
""",
    "objects": """\
# The objects. The descriptor picks an object out in the pictures, as you would say it to someone who looks at them.
#   red_cup: {type: cup, descriptor: "the red cup"}
""",
    "skills": """\
# What can be done, with the types of what it is done with (and to). Continuous parameters have bounds: low, high.
#   - {name: Pick, types: [robot, cup]}
#   - {name: Pour, types: [robot, cup], low: [0], high: [90]}
""",
    "predicates": """\
# The predicates that goals are written in. More are found by learning. Each says where its values come from:
#   vlm       the model is asked, in the words of 'phrase' (one word; by default the name)
#   human     you list the true atoms under 'given', state by state
#   skills    skills set and clear it; for what no camera sees, such as what a hand holds
#   features  computed from numbers of the objects
#   - {name: "On", types: [cup, tray], source: vlm, phrase: standing_on}
#   - {name: Holding, types: [robot, cup], source: skills,
#      set_by: [{skill: Pick, args: [0, 1]}], cleared_by: [{skill: Place, args: [0, 1]}]}
""",
}


def domain_text(name: str, declared: Declarations) -> str:
    """``domain.yaml`` with what is declared; every section, empty ones too, says what belongs there."""
    plain = "".join(c for c in name if c.isprintable())[:100] or "project"
    rows = {
        "types": [_row(doc) for doc in declared.types],
        "objects": [f"  {inline_yaml(n)}: {_row(doc)}" for n, doc in (declared.objects or {}).items()],
        "skills": [_row(doc) for doc in declared.skills],
        "predicates": [_row(doc) for doc in declared.predicates],
    }
    parts = [f"{_HEAD}format: {DomainDoc.FORMAT}\nversion: {VERSION}\nname: {inline_yaml(plain)}\n"]
    for key, comment in _SECTIONS.items():
        parts.append(f"{comment}{_section(key, rows[key])}")
    return "\n".join(parts)


def _section(key: str, rows: Sequence[str]) -> str:
    if not rows:
        return f"{key}: {'{}' if key == 'objects' else '[]'}\n"
    return f"{key}:\n" + "".join(f"{row}\n" if key == "objects" else f"- {row}\n" for row in rows)


def _row(doc: Any) -> str:
    """What a document says that is not the default, as nested YAML on one line."""
    return inline_yaml(doc.model_dump(mode="json", exclude_defaults=True))
