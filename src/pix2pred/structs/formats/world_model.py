"""World models on disk: versioned JSON that loads back equal. Loading never executes anything."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Literal

from pydantic import ValidationError

from pix2pred.structs.formats.building import build_operator, build_predicate, build_vocabulary, check_triggers
from pix2pred.structs.formats.documents import Document, OperatorDoc, PredicateDoc, VocabularyDoc
from pix2pred.structs.formats.knowledge import (
    ImplicationDoc,
    MutexGroupDoc,
    ReliabilityDoc,
    build_invariant,
    build_reliability,
    invariant_doc,
    reliability_doc,
)
from pix2pred.structs.formats.names import DeclaredNames, check_distinct
from pix2pred.structs.formats.writing import operator_doc, predicate_doc, vocabulary_doc
from pix2pred.structs.world_model import WorldModel
from pix2pred.system.errors import Pix2predError, first_fault
from pix2pred.system.files import read_regular

VERSION = 1


class ModelFileError(Pix2predError, ValueError):
    """A file that is not a world model of a version this program reads."""


class WorldModelDoc(Document):
    """The JSON form of a world model."""

    format: Literal["pix2pred-world-model"]
    version: Literal[1]
    labels_from: str
    vocabulary: VocabularyDoc
    selected: tuple[PredicateDoc, ...]
    operators: tuple[OperatorDoc, ...]
    reliability: tuple[ReliabilityDoc, ...] = ()
    invariants: tuple[MutexGroupDoc | ImplicationDoc, ...] = ()


def dump_model(model: WorldModel) -> str:
    """The JSON text of ``model``; equal models give equal text."""
    document: dict[str, Any] = {
        "format": "pix2pred-world-model",
        "version": VERSION,
        "labels_from": model.labels_from,
        "vocabulary": vocabulary_doc(model.vocabulary),
        "selected": [predicate_doc(p) for p in model.selected],
        "operators": [operator_doc(op) for op in model.operators],
    }
    if model.reliability:
        document["reliability"] = [reliability_doc(r) for r in model.reliability]
    if model.invariants:
        document["invariants"] = [invariant_doc(i) for i in model.invariants]
    return json.dumps(document, indent=1) + "\n"


def load_model(path: Path) -> WorldModel:
    """Read a world model. Raises ``ModelFileError`` for anything else, unknown versions included."""
    try:
        data = json.loads(read_regular(path))
    except (OSError, ValueError, RecursionError) as error:
        raise ModelFileError(f"{path}: cannot be read as a world model ({error})") from error
    if not isinstance(data, dict) or data.get("format") != "pix2pred-world-model":
        raise ModelFileError(f"{path}: is not a pix2pred world model")
    version = data.get("version")
    if type(version) is not int or version != VERSION:
        raise ModelFileError(
            f"{path}: has schema version {version!r}; this program reads version {VERSION}. "
            "Install the pix2pred release that wrote it, or learn the model again."
        )
    try:
        return _build_model(WorldModelDoc.model_validate(data))
    except ValidationError as error:
        where, first = first_fault(error)
        raise ModelFileError(f"{path}: {where}: {first['msg']}") from error
    except ValueError as error:
        raise ModelFileError(f"{path}: {error}") from error


def _build_model(doc: WorldModelDoc) -> WorldModel:
    vocabulary = build_vocabulary(doc.vocabulary)
    types = {t.name: t for t in vocabulary.types}
    selected = tuple(build_predicate(p, types) for p in doc.selected)
    predicates = (*vocabulary.initial, *selected)
    check_distinct("predicate", [p.name for p in predicates])
    check_distinct("operator", [o.name for o in doc.operators])
    for predicate in selected:
        check_triggers(predicate, vocabulary.skills)
    names = DeclaredNames(vocabulary.types, vocabulary.skills, predicates)
    return WorldModel(
        vocabulary,
        selected,
        tuple(build_operator(o, names) for o in doc.operators),
        doc.labels_from,
        tuple(build_reliability(r, names) for r in doc.reliability),
        tuple(build_invariant(i, names) for i in doc.invariants),
    )
