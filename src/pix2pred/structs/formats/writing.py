"""From the nouns to what files hold: plain mappings and lists, the same bytes for the same nouns."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from pix2pred.structs.demos import Vocabulary
from pix2pred.structs.objects import Type
from pix2pred.structs.operators import Operator
from pix2pred.structs.predicates import FromFeatures, FromSkills, FromVLM, LiftedAtom, Predicate, source_name
from pix2pred.structs.skills import Skill


def type_doc(t: Type) -> dict[str, Any]:
    """``t`` as written in files."""
    doc: dict[str, Any] = {"name": t.name}
    if t.parent:
        doc["parent"] = t.parent.name
    if t.features:
        doc["features"] = list(t.features)
    said = {"description": t.description, "measures": t.measures}
    return doc | {key: text for key, text in said.items() if text}


def skill_doc(skill: Skill) -> dict[str, Any]:
    """``skill`` as written in files."""
    doc: dict[str, Any] = {"name": skill.name, "types": [t.name for t in skill.types]}
    if skill.dimension:
        doc |= {"low": list(skill.low), "high": list(skill.high)}
    return doc | ({"description": skill.description} if skill.description else {})


def predicate_doc(predicate: Predicate) -> dict[str, Any]:
    """``predicate`` as written in files."""
    doc: dict[str, Any] = {
        "name": predicate.name,
        "types": [t.name for t in predicate.types],
        "source": source_name(predicate.source),
    }
    match predicate.source:
        case FromVLM(phrase, also, opposite, changes):
            doc["phrase"] = phrase
            doc |= {"also": list(also)} if also else {}
            doc |= {"opposite": list(opposite)} if opposite else {}
            doc |= {} if changes else {"changes": False}
        case FromFeatures(expression):
            doc["expression"] = expression
        case FromSkills(set_by, cleared_by, initially):
            doc["set_by"] = [{"skill": t.skill, "args": list(t.args)} for t in set_by]
            doc["cleared_by"] = [{"skill": t.skill, "args": list(t.args)} for t in cleared_by]
            doc["initially"] = initially
    return doc | ({"description": predicate.description} if predicate.description else {})


def operator_doc(op: Operator) -> dict[str, Any]:
    """``op`` as written in files."""

    def atoms(group: Iterable[LiftedAtom]) -> list[list[str]]:
        return [[a.predicate.name, *(v.name for v in a.variables)] for a in sorted(group)]

    return {
        "name": op.name,
        "parameters": [[v.name, v.type.name] for v in op.parameters],
        "preconditions": atoms(op.preconditions),
        "add": atoms(op.add),
        "delete": atoms(op.delete),
        "skill": [op.skill.name, *(v.name for v in op.skill_args)],
        "support": op.support,
    }


def vocabulary_doc(vocabulary: Vocabulary) -> dict[str, Any]:
    """``vocabulary`` as written in files."""
    return {
        "name": vocabulary.name,
        "types": [type_doc(t) for t in vocabulary.types],
        "skills": [skill_doc(s) for s in vocabulary.skills],
        "predicates": [predicate_doc(p) for p in vocabulary.initial],
    }
