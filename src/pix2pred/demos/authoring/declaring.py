"""What a domain needs, said in one line each: types, objects, skills and initial predicates.

::

    cup:item                                        a type and its parent
    box[angle]                                      a type whose objects have numbers
    red_cup:cup = the red cup                       an object, its type, and what picks it out in the pictures
    Pick(robot, cup)                                a skill and the types of its arguments
    Pour(cup)[0..90]                                ... with the bounds of its continuous parameters
    On(cup, tray) = vlm                             an initial predicate and the source of its values
    Hot(cup) = human
    Near(cup, tray) = vlm: next_to                  ... asked with another word
    Open(box) = features: (<= box.angle 0.5)
    Holding(robot, cup) = skills: +Pick(0, 1) -Place(0, 1)
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

from pydantic import ValidationError

from pix2pred.structs import parse_application
from pix2pred.structs.formats.building import build_predicate, build_skill, build_types, check_triggers
from pix2pred.structs.formats.documents import ObjectDoc, PredicateDoc, SkillDoc, TypeDoc
from pix2pred.structs.formats.names import UnknownNameError, check_distinct
from pix2pred.system.errors import Pix2predError

T = TypeVar("T")

_TRIGGER = re.compile(r"([+-])\s*([^\s()+-][^\s()]*)\s*\(([^()]*)\)\s*")


class DeclarationError(Pix2predError, ValueError):
    """Something is declared in a way that cannot be understood; the message has a line for each."""


@dataclass(frozen=True, slots=True)
class Declarations:
    """What ``domain.yaml`` declares, each part possibly empty as yet."""

    types: tuple[TypeDoc, ...] = ()
    objects: Mapping[str, ObjectDoc] | None = None
    skills: tuple[SkillDoc, ...] = ()
    predicates: tuple[PredicateDoc, ...] = ()


def declare(
    types: Sequence[str] = (), objects: Sequence[str] = (), skills: Sequence[str] = (), predicates: Sequence[str] = ()
) -> Declarations:
    """Understand what is declared. Raises ``DeclarationError`` with everything that is wrong."""
    wrong: list[str] = []
    type_docs = _each("type", types, parse_type, wrong)
    object_docs = dict(_each("object", objects, parse_object, wrong))
    skill_docs = _each("skill", skills, parse_skill, wrong)
    predicate_docs = _each("predicate", predicates, parse_predicate, wrong)
    if not wrong:
        _resolve(type_docs, object_docs, skill_docs, predicate_docs, wrong)
        for kind, names in (("object", [parse_object(o)[0] for o in objects]), ("skill", [s.name for s in skill_docs])):
            _note(wrong, kind, "", partial(check_distinct, kind, names))
        _note(wrong, "predicate", "", partial(check_distinct, "predicate", [p.name for p in predicate_docs]))
    if wrong:
        raise DeclarationError("\n".join(wrong))
    return Declarations(tuple(type_docs), object_docs, tuple(skill_docs), tuple(predicate_docs))


def _resolve(
    types: Sequence[TypeDoc], objects: Mapping[str, ObjectDoc], skills: Sequence[SkillDoc],
    predicates: Sequence[PredicateDoc], wrong: list[str],
) -> None:  # fmt: skip
    """Every name that is used has been declared."""
    built = _note(wrong, "type", "", partial(build_types, types))
    if built is None:
        return
    table = {t.name: t for t in built}
    for name, item in objects.items():
        if item.type not in table:
            wrong.append(f"object {name}: {UnknownNameError('type', item.type, table)}")
    made = [_note(wrong, "skill", s.name, partial(build_skill, s, table)) for s in skills]
    built_skills = [skill for skill in made if skill is not None]
    for doc in predicates:
        predicate = _note(wrong, "predicate", doc.name, partial(build_predicate, doc, table))
        if predicate is not None and len(built_skills) == len(skills):
            _note(wrong, "predicate", doc.name, partial(check_triggers, predicate, built_skills))


def _each(kind: str, texts: Sequence[str], parse: Callable[[str], T], wrong: list[str]) -> list[T]:
    parsed = [_note(wrong, kind, repr(text), partial(parse, text)) for text in texts]
    return [one for one in parsed if one is not None]


def _note(wrong: list[str], kind: str, what: str, work: Callable[[], T]) -> T | None:
    """What ``work`` gives; None, with a line in ``wrong``, when it cannot."""
    where = f"{kind} {what}".rstrip()
    try:
        return work()
    except ValidationError as error:
        wrong += [f"{where}: {_said(dict(detail))}" for detail in error.errors(include_url=False)]
    except ValueError as error:
        text = str(error)
        wrong.append(text if text.startswith(where) else f"{where}: {text}")
    return None


def _said(detail: Mapping[str, Any]) -> str:
    if detail["type"] == "string_pattern_mismatch":
        return f"{detail['input']!r} is not a valid name: use letters, digits, '_' and '-', and no spaces"
    return f"{detail['msg']}, found {detail['input']!r}"


def parse_type(text: str) -> TypeDoc:
    """``cup``, ``cup:item``, or with the names of its numbers ``cup:item[x, y]``."""
    head, _, tail = text.partition("[")
    features = tuple(part.strip() for part in tail.strip().removesuffix("]").split(",") if part.strip())
    name, colon, parent = (part.strip() for part in head.partition(":"))
    return TypeDoc(name=name, parent=parent if colon else None, features=features)


def parse_object(text: str) -> tuple[str, ObjectDoc]:
    """``red_cup:cup`` or ``red_cup:cup = the red cup``."""
    head, _, descriptor = (part.strip() for part in text.partition("="))
    name, colon, kind = (part.strip() for part in head.partition(":"))
    if not colon:
        raise ValueError("expected NAME:TYPE, or NAME:TYPE = what picks it out in the pictures")
    TypeDoc(name=name)  # a name like any other
    return name, ObjectDoc(type=kind, descriptor=descriptor)


def parse_skill(text: str) -> SkillDoc:
    """``Pick(robot, cup)`` or, with bounds, ``Pour(cup)[0..90]``."""
    head, bracket, tail = text.partition("[")
    written = parse_application(head)
    low, high = [], []
    if bracket:
        for part in tail.strip().removesuffix("]").split(","):
            left, _, right = part.partition("..")
            try:
                low.append(float(left))
                high.append(float(right))
            except ValueError:
                raise ValueError(f"expected bounds such as [0..1, -1..1], found {part.strip()!r}") from None
    return SkillDoc(name=written.name, types=written.args, low=tuple(low), high=tuple(high))


def parse_predicate(text: str) -> PredicateDoc:
    """``On(cup, tray) = vlm``, with what the source needs after a colon."""
    head, equals, tail = text.partition("=")
    written = parse_application(head)
    source, _, detail = (part.strip() for part in tail.partition(":"))
    if not equals:
        raise ValueError("say where its values come from: = vlm, = human, = skills: ..., or = features: ...")
    if source == "domain":
        raise ValueError("the source 'domain' is for simulators; use vlm, human, skills or features")
    doc: dict[str, Any] = {"name": written.name, "types": written.args, "source": source}
    if detail:
        match source:
            case "vlm":
                doc["phrase"] = detail
            case "features":
                doc["expression"] = detail
            case "skills":
                doc |= _triggers(detail)
            case _:
                raise ValueError(f"the source {source!r} takes nothing more, found {detail!r}")
    elif source == "skills":
        raise ValueError("which skills set and clear it? Write = skills: +Pick(0, 1) -Place(0, 1)")
    return PredicateDoc.model_validate(doc)


def _triggers(text: str) -> dict[str, list[dict[str, Any]]]:
    """``+Pick(0, 1) -Place(0, 1)``: skills that set (+) and clear (-), and their arguments that are meant."""
    found: dict[str, list[dict[str, Any]]] = {"set_by": [], "cleared_by": []}
    position = 0
    while position < len(text):
        match = _TRIGGER.match(text, position)
        if match is None:
            raise ValueError(f"expected +Skill(0, 1) or -Skill(0, 1), found {text[position:]!r}")
        args = [part.strip() for part in match[3].split(",") if part.strip()]
        if not all(re.fullmatch(r"[0-9]{1,3}", arg) for arg in args):
            raise ValueError(f"{match[0].strip()!r}: give the positions of the skill's arguments, counted from 0")
        key = "set_by" if match[1] == "+" else "cleared_by"
        found[key].append({"skill": match[2], "args": [int(arg) for arg in args]})
        position = match.end()
    return found
