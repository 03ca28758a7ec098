"""World models load back equal, and nothing else loads."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from pix2pred.structs import (
    FromDomain,
    FromFeatures,
    FromHuman,
    FromSkills,
    FromVLM,
    LiftedAtom,
    Operator,
    Predicate,
    Skill,
    SkillTrigger,
    Type,
    Variable,
    Vocabulary,
    WorldModel,
)
from pix2pred.structs.documents import Names, ObjectDoc, TypeDoc, UnknownNameError, build_types
from pix2pred.structs.model_file import ModelFileError, dump_model, load_model

THING = Type("thing")
CUP = Type("cup", ("x", "y"), THING)
ROBOT = Type("robot", (), THING)
INITIAL = (
    Predicate("On", (CUP, THING), FromDomain()),
    Predicate("Full", (CUP,), FromHuman()),
    Predicate("Held", (CUP,), FromSkills((SkillTrigger("Pick", (1,)),), (SkillTrigger("Push", (0,)),), True)),
)
SELECTED = (
    Predicate("Hot0", (CUP,), FromVLM("Hot")),
    Predicate("[x<=0.5]", (CUP,), FromFeatures("(<= cup.x 0.5)")),
)
PICK, PUSH = Skill("Pick", (ROBOT, CUP)), Skill("Push", (CUP,), (-0.1, 0.0), (1 / 3, 1e-9))
R, X, Y = Variable("?r", ROBOT), Variable("?x", CUP), Variable("?y", THING)
ON = LiftedAtom(INITIAL[0], (X, Y))
OPERATOR = Operator(
    "Pick1", (R, X, Y),
    frozenset({ON, LiftedAtom(SELECTED[0], (X,)), LiftedAtom(SELECTED[1], (X,))}),
    frozenset({LiftedAtom(INITIAL[2], (X,))}), frozenset({ON}), PICK, (R, X), 7,
)  # fmt: skip
MODEL = WorldModel(Vocabulary("cups", (THING, CUP, ROBOT), (PICK, PUSH), INITIAL), SELECTED, (OPERATOR,), "offline")


def save(path: Path, change: Callable[[dict[str, Any]], object] = lambda data: None) -> Path:
    data = json.loads(dump_model(MODEL))
    change(data)
    path.write_text(json.dumps(data))
    return path


def test_a_model_with_every_source_loads_back_equal(tmp_path: Path) -> None:
    (tmp_path / "m.json").write_text(dump_model(MODEL))
    loaded = load_model(tmp_path / "m.json")
    assert loaded == MODEL
    assert dump_model(loaded) == dump_model(MODEL)
    assert loaded.predicates == tuple(sorted((*INITIAL, *SELECTED)))


def test_types_may_come_before_their_parents() -> None:
    docs = [TypeDoc(name="cup", parent="thing"), TypeDoc(name="thing")]
    assert build_types(docs) == (Type("cup", (), THING), THING)


REFUSED: dict[str, tuple[Callable[[dict[str, Any]], object], str]] = {
    "newer version": (lambda d: d.update(version=2), "schema version 2"),
    "no version": (lambda d: d.pop("version"), "schema version None"),
    "other format": (lambda d: d.update(format="pddl"), "not a pix2pred world model"),
    "unknown key": (lambda d: d.update(code="import os"), "code"),
    "unknown key inside": (lambda d: d["operators"][0].update(cost=1), r"operators\.0\.cost"),
    "unknown type": (lambda d: d["selected"][0].update(types=["cop"]), "did you mean 'cup'"),
    "unknown predicate": (lambda d: d["operators"][0].update(add=[["Helt", "?x"]]), "did you mean 'Held'"),
    "unknown variable": (lambda d: d["operators"][0].update(add=[["Held", "?z"]]), "variable '\\?z'"),
    "unknown skill": (lambda d: d["operators"][0].update(skill=["Pik", "?r", "?x"]), "did you mean 'Pick'"),
    "unknown source": (lambda d: d["selected"][0].update(source="oracle"), "source"),
    "repeated skill": (lambda d: d["vocabulary"]["skills"].append(d["vocabulary"]["skills"][0]), "declared twice"),
    "type cycle": (lambda d: d["vocabulary"]["types"][0].update(parent="cup"), "its own ancestor"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_other_documents_are_refused(tmp_path: Path, case: str) -> None:
    change, message = REFUSED[case]
    with pytest.raises(ModelFileError, match=message):
        load_model(save(tmp_path / "m.json", change))


@pytest.mark.parametrize("content", [b"", b"\xff", b"[]", b"null", b'{"format": 1}', b"{"])
def test_junk_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "m.json").write_bytes(content)
    with pytest.raises(ModelFileError, match=r"m\.json"):
        load_model(tmp_path / "m.json")


def test_a_missing_file_is_a_model_file_error(tmp_path: Path) -> None:
    with pytest.raises(ModelFileError):
        load_model(tmp_path / "none.json")


def test_names_suggest_and_check() -> None:
    names = Names((THING, CUP, ROBOT), (PICK, PUSH), INITIAL)
    objects = {n: names.object(n, ObjectDoc(type=t)) for n, t in (("a", "cup"), ("r", "robot"))}
    assert names.atom("On", ["a", "r"], objects) == INITIAL[0](objects["a"], objects["r"])
    assert objects["a"].descriptor == "a"
    with pytest.raises(UnknownNameError, match="did you mean 'cup'"):
        names.type("cip")
    with pytest.raises(ValueError, match="r is a robot, not a cup"):
        names.atom("Full", ["r"], objects)
    with pytest.raises(ValueError, match="takes 1 arguments, found 2"):
        names.atom("Full", ["a", "a"], objects)
    with pytest.raises(ValueError, match="takes 2 continuous parameters, found 1"):
        names.action("Push", ["a"], [0.5], objects)
