"""Reliability of labels and invariants as parts of a world model's file; models of before have neither."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

from pydantic import Field

from pix2pred.structs.formats.documents import Applied, Document, Name
from pix2pred.structs.formats.names import DeclaredNames, check_distinct
from pix2pred.structs.knowledge import Implication, Invariant, MutexGroup, Reliability
from pix2pred.structs.objects import Variable
from pix2pred.structs.predicates import LiftedAtom

DIGITS = 6
"""Decimal places of probabilities in files: estimates from some hundred labels hold no more."""

Typed = tuple[str, Name]
"""A variable and its type."""


class ReliabilityDoc(Document):
    """How far the labels of one predicate can be trusted."""

    predicate: str
    error: float = Field(ge=0, le=1)
    unknown: float = Field(ge=0, le=1)
    initially: float = Field(ge=0, le=1)


class MutexGroupDoc(Document):
    """A group of atoms of which at most one holds, or exactly one; ``counted`` variables stand for any object."""

    kind: Literal["at most one", "exactly one"]
    fixed: tuple[Typed, ...]
    counted: tuple[Typed, ...]
    atoms: tuple[Applied, ...] = Field(min_length=1)
    support: int = Field(ge=0)


class ImplicationDoc(Document):
    """An atom that holds whenever another one does."""

    kind: Literal["implies"]
    variables: tuple[Typed, ...]
    premise: Applied
    conclusion: Applied
    support: int = Field(ge=0)


def reliability_doc(known: Reliability) -> dict[str, Any]:
    """``known`` as written in files."""
    return {
        "predicate": known.predicate.name,
        "error": round(known.error, DIGITS),
        "unknown": round(known.unknown, DIGITS),
        "initially": round(known.initially, DIGITS),
    }


def build_reliability(doc: ReliabilityDoc, names: DeclaredNames) -> Reliability:
    """What ``doc`` says. Raises ``ValueError`` for a predicate that is not declared."""
    return Reliability(names.predicate(doc.predicate), doc.error, doc.unknown, doc.initially)


def invariant_doc(invariant: Invariant) -> dict[str, Any]:
    """``invariant`` as written in files."""
    match invariant:
        case MutexGroup(fixed, atoms, exactly, support):
            counted = sorted({v for a in atoms for v in a.variables} - set(fixed))
            return {
                "kind": "exactly one" if exactly else "at most one",
                "fixed": [[v.name, v.type.name] for v in fixed],
                "counted": [[v.name, v.type.name] for v in counted],
                "atoms": [_applied(a) for a in sorted(atoms)],
                "support": support,
            }
        case Implication(premise, conclusion, support):
            return {
                "kind": "implies",
                "variables": [[v.name, v.type.name] for v in premise.variables],
                "premise": _applied(premise),
                "conclusion": _applied(conclusion),
                "support": support,
            }


def build_invariant(doc: MutexGroupDoc | ImplicationDoc, names: DeclaredNames) -> Invariant:
    """The invariant described by ``doc``. Raises ``ValueError`` for names that are not declared."""
    if isinstance(doc, ImplicationDoc):
        variables = _variables(doc.variables, names)
        premise, conclusion = names.lifted(doc.premise, variables), names.lifted(doc.conclusion, variables)
        return Implication(premise, conclusion, doc.support)
    variables = _variables((*doc.fixed, *doc.counted), names)
    fixed = tuple(variables[name] for name, _ in doc.fixed)
    atoms = frozenset(names.lifted(parts, variables) for parts in doc.atoms)
    return MutexGroup(fixed, atoms, doc.kind == "exactly one", doc.support)


def _variables(typed: Sequence[Typed], names: DeclaredNames) -> dict[str, Variable]:
    check_distinct("variable", [name for name, _ in typed])
    return {name: Variable(name, names.type(type_name)) for name, type_name in typed}


def _applied(atom: LiftedAtom) -> list[str]:
    return [atom.predicate.name, *(v.name for v in atom.variables)]
