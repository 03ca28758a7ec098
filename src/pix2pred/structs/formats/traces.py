"""Labelled demonstrations as one JSON file, plain or gzipped: symbols in, no pictures needed (format pix2pred-traces).

Errors name the JSON path and the offending value.
"""

from __future__ import annotations

import gzip
import json
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError

from pix2pred.structs import Action, Atom, Candidate, Label, LabelledDemo, Object, Predicate, TruthTable, Vocabulary
from pix2pred.structs.formats.building import build_predicate, build_skill, build_types
from pix2pred.structs.formats.documents import Document, Name, ObjectDoc, PredicateDoc, SkillDoc, TypeDoc
from pix2pred.structs.formats.names import DeclaredNames
from pix2pred.structs.formats.writing import predicate_doc, skill_doc, type_doc
from pix2pred.structs.goals.opposites import contrary
from pix2pred.system.errors import Pix2predError

NOT = "not "
"""What stands before the name of a predicate in a goal of which an atom must not hold; names have no blanks."""

MAX_BYTES = 1 << 30
"""Larger files, unpacked, are refused."""


class TracesError(Pix2predError, ValueError):
    """A file that does not follow the traces format; the message names the JSON path."""


class TracePredicateDoc(PredicateDoc):
    """A predicate, whether it is given or a candidate, and its cost (default: its arity)."""

    kind: Literal["given", "candidate"]
    cost: float | None = Field(None, ge=0, allow_inf_nan=False)


class TraceDemoDoc(Document):
    """One demonstration; atoms and actions are lists of a name and object names."""

    name: Name | None = None
    objects: dict[str, Name]
    goal: tuple[tuple[str, ...], ...] = Field(description="atoms; 'not NAME' says that one does not hold")
    alternatives: tuple[tuple[tuple[str, ...], ...], ...] = Field((), description="goals that are as good")
    actions: tuple[tuple[str, ...], ...]
    states: tuple[tuple[tuple[str, ...], ...], ...]
    failed: tuple[int, ...] = Field((), description="numbers of the actions that failed, from 0")
    unknown: tuple[tuple[tuple[str, ...], ...], ...] | None = None
    confidence: tuple[tuple[tuple[tuple[str, ...], Annotated[float, Field(ge=0, le=1)]], ...], ...] | None = None
    """Per state, atoms with the probability of their label, where one is known."""


class TracesDoc(Document):
    """The whole file."""

    format: Literal["pix2pred-traces"]
    version: Literal[1]
    types: tuple[TypeDoc, ...]
    skills: tuple[SkillDoc, ...]
    predicates: tuple[TracePredicateDoc, ...]
    demos: tuple[TraceDemoDoc, ...]
    settings: dict[str, Any] = Field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Traces:
    """A truth table with the vocabulary it is written in and the settings the file asks for."""

    vocabulary: Vocabulary
    table: TruthTable
    settings: Mapping[str, Any]


def load_traces(path: Path) -> Traces:
    """Read a traces file. Raises ``TracesError``."""
    try:
        document = TracesDoc.model_validate(_read_json(path))
    except ValidationError as error:
        first = error.errors()[0]
        found = "" if first["type"] == "missing" else f", found {json.dumps(first['input'], default=str)[:80]}"
        raise TracesError(f"{path}: {_json_path(first['loc'])}: {first['msg']}{found}") from error
    return _Builder(path, document).build()


def _read_json(path: Path) -> object:
    try:
        raw = path.read_bytes()
        if raw[:2] == b"\x1f\x8b":
            with gzip.open(path) as stream:
                raw = stream.read(MAX_BYTES + 1)
        if len(raw) > MAX_BYTES:
            raise TracesError(f"{path}: more than {MAX_BYTES} bytes")
        return json.loads(raw)
    except TracesError:
        raise
    except (OSError, EOFError, ValueError, RecursionError, zlib.error) as error:
        raise TracesError(f"{path}: cannot be read as JSON ({error})") from error


def _json_path(parts: Sequence[str | int]) -> str:
    return "$" + "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in parts)


class _Builder:
    def __init__(self, path: Path, document: TracesDoc) -> None:
        self._path = path
        self._doc = document

    def build(self) -> Traces:
        """Everything in the document, names resolved."""
        types = self._at("$.types", build_types, self._doc.types)
        table = {t.name: t for t in types}
        skills = tuple(self._at(f"$.skills[{i}]", build_skill, s, table) for i, s in enumerate(self._doc.skills))
        predicates = tuple(
            self._at(f"$.predicates[{i}]", build_predicate, p, table) for i, p in enumerate(self._doc.predicates)
        )
        self._refuse_repeats("skills", [s.name for s in skills])
        self._refuse_repeats("predicates", [p.name for p in predicates])
        self._names = DeclaredNames(types, skills, predicates)
        pairs = list(zip(self._doc.predicates, predicates, strict=True))
        initial = tuple(p for doc, p in pairs if doc.kind == "given")
        pool = tuple(
            Candidate(p, float(p.arity if doc.cost is None else doc.cost))
            for doc, p in pairs
            if doc.kind == "candidate"
        )
        demos = tuple(self._demo(d, doc, initial) for d, doc in enumerate(self._doc.demos))
        self._refuse_repeats("demos", [demo.name for demo in demos])
        if any(demo.name == "domain" for demo in demos):
            raise TracesError(f"{self._path}: $.demos: no demonstration may be called 'domain', as PDDL domains are")
        if not demos:
            raise TracesError(f"{self._path}: $.demos: is empty; at least one demonstration is needed")
        vocabulary = Vocabulary("traces", types, skills, initial)
        return Traces(vocabulary, TruthTable(initial, pool, demos), self._doc.settings)

    def _at(self, where: str, make: Any, *args: Any) -> Any:
        try:
            return make(*args)
        except ValueError as error:
            raise TracesError(f"{self._path}: {where}: {error}") from error

    def _refuse_repeats(self, what: str, names: Sequence[str]) -> None:
        for i, name in enumerate(names):
            if name in names[:i]:
                raise TracesError(f"{self._path}: $.{what}[{i}].name: {name!r} is declared twice")

    def _demo(self, d: int, doc: TraceDemoDoc, initial: tuple[Predicate, ...]) -> LabelledDemo:
        here = f"$.demos[{d}]"
        objects = {
            name: self._at(f"{here}.objects.{name}", self._names.object, name, ObjectDoc(type=type_name))
            for name, type_name in doc.objects.items()
        }
        if len(doc.states) != len(doc.actions) + 1:
            raise TracesError(
                f"{self._path}: {here}.states: {len(doc.actions)} actions need {len(doc.actions) + 1} states, "
                f"found {len(doc.states)}"
            )
        if doc.unknown is not None and len(doc.unknown) != len(doc.states):
            raise TracesError(f"{self._path}: {here}.unknown: must have one entry per state")
        if doc.confidence is not None and len(doc.confidence) != len(doc.states):
            raise TracesError(f"{self._path}: {here}.confidence: must have one entry per state")
        actions = tuple(self._action(f"{here}.actions[{i}]", parts, objects) for i, parts in enumerate(doc.actions))
        if beyond := [i for i in doc.failed if not 0 <= i < len(actions)]:
            raise TracesError(f"{self._path}: {here}.failed: there is no action {beyond[0]}")
        actions = tuple(replace(a, failed=i in doc.failed) for i, a in enumerate(actions))
        goal = self._goal(f"{here}.goal", doc.goal, objects, initial)
        alternatives = tuple(
            self._goal(f"{here}.alternatives[{i}]", other, objects, initial) for i, other in enumerate(doc.alternatives)
        )
        held = self._listed(f"{here}.states", doc.states, objects)
        unknown = self._listed(f"{here}.unknown", doc.unknown or ((),) * len(doc.states), objects)
        sure = [
            {self._atom(f"{here}.confidence[{t}][{i}]", parts, objects): p for i, (parts, p) in enumerate(state)}
            for t, state in enumerate(doc.confidence or ())
        ]
        atoms = tuple(sorted(set().union(*held, *unknown, *sure)))
        column = {a: i for i, a in enumerate(atoms)}
        values = np.full((len(held), len(atoms)), Label.FALSE, dtype=np.int8)
        for t in range(len(held)):
            values[t, [column[a] for a in held[t]]] = Label.TRUE
            values[t, [column[a] for a in unknown[t]]] = Label.UNKNOWN
        confidence = np.full(values.shape, np.nan, dtype=np.float32)
        for t, state in enumerate(sure):
            confidence[t, [column[a] for a in state]] = list(state.values())
        name = doc.name or f"demo-{d}"
        return LabelledDemo(
            name,
            tuple(sorted(objects.values())),
            actions,
            goal,
            atoms,
            values,
            confidence if sure else None,
            alternatives,
        )  # fmt: skip

    def _goal(
        self, where: str, doc: Sequence[Sequence[str]], objects: Mapping[str, Object], given: Sequence[Predicate]
    ) -> tuple[Atom, ...]:
        goal = set()
        for i, parts in enumerate(doc):
            here = f"{where}[{i}]"
            denied = bool(parts) and parts[0].startswith(NOT)
            atom = self._atom(here, (parts[0].removeprefix(NOT), *parts[1:]) if denied else parts, objects)
            if atom.predicate not in given:
                raise TracesError(f"{self._path}: {here}: {atom} is not over a given predicate")
            goal.add(contrary(atom) if denied else atom)
            if contrary(atom) in goal and atom in goal:
                raise TracesError(f"{self._path}: {here}: {atom} is to hold and not to hold: the goal can never hold")
        return tuple(sorted(goal))

    def _listed(
        self, where: str, states: Sequence[Sequence[Sequence[str]]], objects: Mapping[str, Object]
    ) -> list[set[Atom]]:
        return [
            {self._atom(f"{where}[{t}][{i}]", parts, objects) for i, parts in enumerate(state)}
            for t, state in enumerate(states)
        ]

    def _atom(self, where: str, parts: Sequence[str], objects: Mapping[str, Object]) -> Atom:
        if not parts:
            raise TracesError(f"{self._path}: {where}: an atom is a list of a predicate and objects, found []")
        atom: Atom = self._at(where, self._names.atom, parts[0], parts[1:], objects)
        return atom

    def _action(self, where: str, parts: Sequence[str], objects: Mapping[str, Object]) -> Action:
        if not parts:
            raise TracesError(f"{self._path}: {where}: an action is a list of a skill and objects, found []")
        skill = self._at(where, self._names.skill, parts[0])
        action: Action = self._at(where, self._names.action, parts[0], parts[1:], skill.low, objects)
        return action


def dump_traces(vocabulary: Vocabulary, table: TruthTable, settings: Mapping[str, Any]) -> str:
    """The JSON text of a truth table; reads back with ``load_traces``."""
    costs = {c.predicate: c.cost for c in table.pool}
    predicates = [predicate_doc(p) | {"kind": "given"} for p in table.initial]
    predicates += [predicate_doc(c.predicate) | {"kind": "candidate", "cost": costs[c.predicate]} for c in table.pool]
    document = {
        "format": "pix2pred-traces",
        "version": 1,
        "types": [type_doc(t) for t in vocabulary.types],
        "skills": [skill_doc(s) for s in vocabulary.skills],
        "predicates": predicates,
        "settings": dict(settings),
    }
    demos = ",\n".join(json.dumps(_demo_doc(demo)) for demo in table.demos)
    return json.dumps(document, indent=1)[:-2] + f',\n "demos": [\n{demos}\n ]\n}}\n'


def _demo_doc(demo: LabelledDemo) -> dict[str, Any]:
    def rows(value: int) -> list[list[list[str]]]:
        return [[_parts(demo.atoms[i]) for i in np.flatnonzero(row == value)] for row in demo.values]

    doc: dict[str, Any] = {
        "name": demo.name,
        "objects": {o.name: o.type.name for o in demo.objects},
        "goal": [_parts(a) for a in demo.goal],
        **({"alternatives": [[_parts(a) for a in goal] for goal in demo.alternatives]} if demo.alternatives else {}),
        "actions": [[a.skill.name, *(o.name for o in a.objects)] for a in demo.actions],
        "states": rows(Label.TRUE),
    }
    if failed := [i for i, action in enumerate(demo.actions) if action.failed]:
        doc["failed"] = failed
    if (demo.values == Label.UNKNOWN).any():
        doc["unknown"] = rows(Label.UNKNOWN)
    if demo.confidence is not None:
        doc["confidence"] = [
            [[_parts(demo.atoms[i]), round(float(row[i]), 4)] for i in np.flatnonzero(np.isfinite(row))]
            for row in demo.confidence
        ]
    return doc


def _parts(atom: Atom) -> list[str]:
    return [atom.predicate.name, *(o.name for o in atom.objects)]
