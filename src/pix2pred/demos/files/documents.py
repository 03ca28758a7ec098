"""The three files of a project folder as pydantic models, and their reading with file-and-line problems."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, TypeVar

from pydantic import BeforeValidator, Discriminator, Field, StringConstraints, Tag, ValidationError, WithJsonSchema
from pydantic_core import ErrorDetails

from pix2pred.demos.files.folders import refusal
from pix2pred.demos.files.problems import Problem
from pix2pred.demos.files.yaml_lines import LinedData, Loc, YamlError, parse_yaml
from pix2pred.structs.formats.documents import Document, Name, ObjectDoc, PredicateDoc, SkillDoc, TypeDoc

VERSION = 1
MAX_PROBLEMS = 100
"""Problems reported for the form of one file; the rest is counted."""

D = TypeVar("D", bound="FileDoc")

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
"""A finite number; text and truth values are not taken for one."""

CAMERA_PATTERN = r"^[A-Za-z0-9][A-Za-z0-9_\-]*$"
Camera = Annotated[str, StringConstraints(pattern=CAMERA_PATTERN, max_length=100)]
"""A camera's name, which is its pictures' file name without the ending."""

BoxDoc = Annotated[tuple[Number, ...], Field(min_length=4, max_length=4, description="left, top, right, bottom")]

_BOXES_SCHEMA = {
    "type": ["object", "null"],
    "description": "boxes of objects in the picture: name: [left, top, right, bottom] in pixels",
    "additionalProperties": {"type": "array", "items": {"type": "number"}, "minItems": 4, "maxItems": 4},
}

Boxes = Annotated[
    dict[str, BoxDoc],
    BeforeValidator(lambda value: {} if value is None else value),
    WithJsonSchema(_BOXES_SCHEMA, mode="validation"),
]


def _form(value: object) -> str:
    return "<mapping>" if isinstance(value, Mapping) else "<list>"


Objects = Annotated[
    Annotated[tuple[str, ...], Tag("<list>")] | Annotated[dict[Name, ObjectDoc], Tag("<mapping>")], Discriminator(_form)
]
"""Names declared in ``domain.yaml``, or a mapping of names to type and descriptor."""


class FileDoc(Document):
    """A file that names its format and version."""

    FORMAT: ClassVar[str]


class SimulatorDoc(Document):
    """The registered domain, and the family of it, that can execute the tasks."""

    domain: Name
    family: Name


class DomainDoc(FileDoc):
    """``domain.yaml``: what is declared for all demonstrations and tasks."""

    FORMAT = "pix2pred-domain"

    format: Literal["pix2pred-domain"]
    version: Literal[1]
    name: Annotated[str, StringConstraints(pattern=r"^[^\x00-\x1f]+$", max_length=100)]
    simulator: SimulatorDoc | None = None
    types: tuple[TypeDoc, ...]
    objects: dict[Name, ObjectDoc] = Field(default_factory=dict)
    skills: tuple[SkillDoc, ...]
    predicates: tuple[PredicateDoc, ...] = Field(description="the initial predicates")
    learning: dict[str, Any] = Field(default_factory=dict, description="settings passed on as they are")
    proposal: dict[str, Any] = Field(default_factory=dict, description="likewise, of asking for predicates")
    labels: dict[str, Any] = Field(default_factory=dict, description="likewise, of asking for their values")


class StateDoc(Document):
    """A state: features in the order of the type's, true given atoms, boxes by camera and object."""

    features: dict[str, tuple[Number, ...]] = Field(default_factory=dict)
    given: tuple[str, ...] = ()
    pictures: dict[Camera, Boxes] | None = Field(default=None, description="default: every PNG and JPEG in images/<t>/")


class DemoDoc(FileDoc):
    """``demo.yaml``: one more state than actions."""

    FORMAT = "pix2pred-demo"

    format: Literal["pix2pred-demo"]
    version: Literal[1]
    objects: Objects
    goal: tuple[str, ...]
    actions: tuple[str, ...]
    states: tuple[StateDoc, ...]


class TaskDoc(FileDoc):
    """``task.yaml``: the state to start from and the goal to reach."""

    FORMAT = "pix2pred-task"

    format: Literal["pix2pred-task"]
    version: Literal[1]
    objects: Objects
    goal: tuple[str, ...]
    state: StateDoc = StateDoc()


@dataclass(frozen=True, slots=True)
class Sheet:
    """A file being read: where its problems are collected, each with the line of the entry it concerns."""

    file: Path
    yaml: LinedData
    found: list[Problem]

    def report(self, loc: Loc, message: str) -> None:
        """Note a problem with the entry at ``loc``."""
        self.found.append(Problem(self.file, self.yaml.line(loc), message))


def load_document(file: Path, root: Path, document: type[D], found: list[Problem]) -> tuple[Sheet, D] | None:
    """Read ``file``; None, with problems in ``found``, when it is not a valid ``document``."""
    if message := refusal(file, root):
        found.append(Problem(file, None, message))
        return None
    try:
        lined = parse_yaml(file.read_bytes())
    except OSError as error:
        found.append(Problem(file, None, f"cannot be read ({error.strerror})"))
        return None
    except YamlError as error:
        found.append(Problem(file, error.line, error.message))
        return None
    sheet = Sheet(file, lined, found)
    if not _is_format(sheet, document):
        return None
    valid = _validated(sheet, document)
    return (sheet, valid) if valid else None


def _validated(sheet: Sheet, document: type[D]) -> D | None:
    """The document, without keys that no such file has; they are reported, and hide nothing else that is wrong."""
    data = sheet.yaml.data
    try:
        return document.model_validate(data)
    except ValidationError as error:
        details = sorted(error.errors(include_url=False), key=lambda detail: sheet.yaml.line(detail["loc"]))
    for detail in details[:MAX_PROBLEMS]:
        sheet.report(detail["loc"], _message(detail, document))
    if len(details) > MAX_PROBLEMS:
        message = f"... and {len(details) - MAX_PROBLEMS} more problems in this file"
        sheet.report(details[MAX_PROBLEMS]["loc"], message)
    if any(detail["type"] != "extra_forbidden" for detail in details):
        return None
    try:
        return document.model_validate(_without(data, {detail["loc"] for detail in details}))
    except ValidationError:  # a place inside a union, whose names in an error are not all keys
        return None


def _without(data: Any, locs: Collection[Loc], here: Loc = ()) -> Any:
    """``data`` without the entries at ``locs``."""
    if isinstance(data, dict):
        return {k: _without(v, locs, (*here, k)) for k, v in data.items() if (*here, k) not in locs}
    if isinstance(data, list):
        return [_without(entry, locs, (*here, i)) for i, entry in enumerate(data)]
    return data


def _is_format(sheet: Sheet, document: type[FileDoc]) -> bool:
    data = sheet.yaml.data
    if not isinstance(data, dict) or data.get("format") != document.FORMAT:
        sheet.report(("format",), f"this is not a {document.FORMAT} file; start it with 'format: {document.FORMAT}'")
        return False
    if type(data.get("version")) is not int or data["version"] != VERSION:
        found = _shown(data["version"]) if "version" in data else "none"
        sheet.report(
            ("version",),
            f"the format's version is {found}, this program reads version {VERSION}; write 'version: {VERSION}', "
            "or use the pix2pred release that wrote the file",
        )
        return False
    return True


def _keys(document: type[FileDoc]) -> list[str]:
    """Every key that occurs somewhere in a file of this kind."""
    schema = document.model_json_schema()
    return sorted({key for part in (schema, *schema["$defs"].values()) for key in part.get("properties", ())})


def _message(detail: ErrorDetails, document: type[FileDoc]) -> str:
    """What a pydantic error means for the person who wrote the file."""
    shown = _shown(detail["input"])
    last = detail["loc"][-1] if detail["loc"] else ""
    match detail["type"]:
        case "missing":
            return f"key {last!r} is missing"
        case "extra_forbidden":
            close = difflib.get_close_matches(str(last), _keys(document), n=1)
            return f"unknown key {last!r}" + (f"; did you mean {close[0]!r}?" if close else "; remove it")
        case "string_type":
            return f"expected text, found {shown}; put it in quotes if it is meant as text"
        case "tuple_type":
            return f"expected a list, found {shown}"
        case "dict_type" | "model_type" | "model_attributes_type":
            return f"expected a mapping (key: value), found {shown}"
        case "float_type" | "finite_number":
            return f"expected a finite number, found {shown}"
        case "too_short" | "too_long" if "pictures" in detail["loc"]:
            return f"expected 4 numbers [left, top, right, bottom], found {shown}"
        case "string_pattern_mismatch":
            return f"{shown} is not a valid name: use letters, digits, '_' and '-', and no spaces"
        case _:
            return f"{detail['msg']}, found {shown}"


def _shown(value: object) -> str:
    """``value`` as quoted in a message, cut when long. A container is not printed whole to be cut."""
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list) and len(value) > 6:
        return f"a list of {len(value)} entries"
    text = "nothing" if value is None else repr(value)
    return text if len(text) <= 80 else text[:77] + "..."
