"""World models load back equal, and nothing else loads."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

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
from pix2pred.structs.formats.building import build_types
from pix2pred.structs.formats.documents import ObjectDoc, TypeDoc
from pix2pred.structs.formats.names import DeclaredNames, UnknownNameError
from pix2pred.structs.formats.world_model import ModelFileError, dump_model, load_model

THING = Type("thing")
CUP = Type("cup", ("x", "y"), THING)
ROBOT = Type("robot", (), THING)
INITIAL = (
    Predicate("On", (CUP, THING), FromDomain()),
    Predicate("Full", (CUP,), FromHuman()),
    Predicate("Held", (CUP,), FromSkills((SkillTrigger("Pick", (1,)),), (SkillTrigger("Push", (0,)),), True)),
)
SELECTED = (Predicate("Hot0", (CUP,), FromVLM("Hot")), Predicate("[x<=0.5]", (CUP,), FromFeatures("(<= cup.x 0.5)")))
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
    assert [p.source for p in loaded.predicates] == [p.source for p in MODEL.predicates]
    assert dump_model(loaded) == dump_model(MODEL)
    assert loaded.predicates == tuple(sorted((*INITIAL, *SELECTED)))


def test_types_may_come_before_their_parents() -> None:
    docs = [TypeDoc(name="cup", parent="thing"), TypeDoc(name="thing")]
    assert build_types(docs) == (Type("cup", (), THING), THING)


def trigger(data: dict[str, Any], **changes: object) -> None:
    data["vocabulary"]["predicates"][2]["set_by"][0].update(changes)


def chain(length: int) -> list[dict[str, str]]:
    """Types in which each is the parent of the next."""
    return [{"name": "t0"}, *({"name": f"t{i}", "parent": f"t{i - 1}"} for i in range(1, length))]


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
    "true as version": (lambda d: d.update(version=True), "schema version True"),
    "fractional version": (lambda d: d.update(version=1.0), r"schema version 1\.0"),
    "empty atom": (lambda d: d["operators"][0].update(add=[[]]), r"operators\.0\.add\.0"),
    "empty skill": (lambda d: d["operators"][0].update(skill=[]), r"operators\.0\.skill"),
    "wrong arity": (lambda d: d["operators"][0].update(add=[["Held", "?x", "?x"]]), "Pick1: .*takes 1 .* found 2"),
    "wrong type": (lambda d: d["operators"][0].update(add=[["Held", "?r"]]), r"\?r is a robot, not a cup"),
    "wider type": (lambda d: d["operators"][0].update(add=[["Held", "?y"]]), r"\?y is a thing, not a cup"),
    "skill arity": (lambda d: d["operators"][0].update(skill=["Pick", "?r"]), "skill Pick takes 2 .* found 1"),
    "skill type": (lambda d: d["operators"][0].update(skill=["Pick", "?x", "?x"]), r"\?x is a cup, not a robot"),
    "repeated parameter": (
        lambda d: d["operators"][0]["parameters"].append(["?x", "cup"]),
        r"Pick1: parameter '\?x' is declared twice",
    ),
    "repeated operator": (lambda d: d["operators"].append(d["operators"][0]), "operator 'Pick1' is declared twice"),
    "negative support": (lambda d: d["operators"][0].update(support=-1), r"operators\.0\.support"),
    "selected repeats initial": (lambda d: d["selected"][0].update(name="On"), "predicate 'On' is declared twice"),
    "selected repeated": (lambda d: d["selected"].append(d["selected"][0]), "predicate 'Hot0' is declared twice"),
    "trigger of no skill": (lambda d: trigger(d, skill="Pikc"), "did you mean 'Pick'"),
    "trigger beyond": (lambda d: trigger(d, args=[2]), r"skill Pick\(robot, cup\) has no argument 2"),
    "trigger below": (lambda d: trigger(d, args=[-1]), "has no argument -1"),
    "trigger arity": (lambda d: trigger(d, args=[1, 1]), "takes 1 arguments, args has 2"),
    "trigger type": (lambda d: trigger(d, args=[0]), "argument 0 .* is a robot, not a cup"),
    "trigger of a selected one": (
        lambda d: d["selected"][0].update(source="skills", set_by=[{"skill": "Pick", "args": [7]}]),
        "no argument 7",
    ),
    "bound not a number": (lambda d: d["vocabulary"]["skills"][1].update(low=[0, float("nan")]), "not a number"),
    "endless bound": (lambda d: d["vocabulary"]["skills"][1].update(high=[1, float("inf")]), "not finite"),
    "bounds crossed": (lambda d: d["vocabulary"]["skills"][1].update(low=[9, 9]), "low <= high"),
    "repeated feature": (lambda d: d["vocabulary"]["types"][1].update(features=["x", "x"]), "cup: feature 'x'"),
    "repeated type": (lambda d: d["vocabulary"]["types"].append({"name": "cup"}), "type 'cup' is declared twice"),
    "endless ancestors": (lambda d: d["vocabulary"]["types"].extend(chain(5000)), "more than 50 ancestors"),
    "type cycle": (lambda d: d["vocabulary"]["types"][0].update(parent="cup"), "its own ancestor"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_other_documents_are_refused(tmp_path: Path, case: str) -> None:
    change, message = REFUSED[case]
    with pytest.raises(ModelFileError, match=message):
        load_model(save(tmp_path / "m.json", change))


def test_fifty_ancestors_are_fine(tmp_path: Path) -> None:
    load_model(save(tmp_path / "m.json", lambda d: d["vocabulary"]["types"].extend(reversed(chain(51)))))


JSON_VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=5)
    | st.sampled_from(["cup", "On", "?x"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)


def places(data: object, way: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The way to every value inside a JSON document."""
    inside = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    return [way, *(w for key, value in inside for w in places(value, (*way, key)))]


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(chosen=st.sampled_from(places(json.loads(dump_model(MODEL)))[1:]), value=JSON_VALUES)
def test_any_change_of_a_value_loads_or_is_refused(tmp_path: Path, chosen: tuple[Any, ...], value: object) -> None:
    def change(data: Any) -> None:
        for key in chosen[:-1]:
            data = data[key]
        data[chosen[-1]] = value

    with contextlib.suppress(ModelFileError):
        load_model(save(tmp_path / "m.json", change))


JUNK = [b"", b"\xff", b"[]", b"null", b'{"format": 1}', b"{", b"[" * 100_000, b'{"a":' * 100_000, b"9" * 10_000]


@pytest.mark.parametrize("content", JUNK, ids=lambda junk: str(junk[:8]))
def test_junk_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "m.json").write_bytes(content)
    with pytest.raises(ModelFileError, match=r"m\.json"):
        load_model(tmp_path / "m.json")


def test_a_missing_file_is_a_model_file_error(tmp_path: Path) -> None:
    with pytest.raises(ModelFileError):
        load_model(tmp_path / "none.json")


def test_names_suggest_and_check() -> None:
    names = DeclaredNames((THING, CUP, ROBOT), (PICK, PUSH), INITIAL)
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


def test_reliability_and_invariants_load_back_equal_and_old_files_have_neither(tmp_path: Path) -> None:
    from pix2pred.structs import FromVLM, LiftedAtom, Predicate, Type, Variable, Vocabulary, WorldModel
    from pix2pred.structs.knowledge import Implication, MutexGroup, Reliability

    cup = Type("cup")
    full, empty = (Predicate(name, (cup,), FromVLM(name)) for name in ("full", "empty"))
    x = Variable("?x", cup)
    one = MutexGroup((x,), frozenset({LiftedAtom(full, (x,)), LiftedAtom(empty, (x,))}), True, 12)
    implied = Implication(LiftedAtom(full, (x,)), LiftedAtom(empty, (x,)), 3)
    model = WorldModel(
        Vocabulary("tea", (cup,), (), ()), (empty, full), (), "told",
        (Reliability(full, 0.02, 0.1, 0.5),), (one, implied),
    )  # fmt: skip
    path = tmp_path / "model.json"
    path.write_text(dump_model(model))
    loaded = load_model(path)
    assert loaded == model and loaded.reliability == model.reliability and loaded.invariants == model.invariants
    old = WorldModel(model.vocabulary, model.selected, (), "told")
    assert "reliability" not in dump_model(old) and "invariants" not in dump_model(old)
    path.write_text(dump_model(old))
    assert load_model(path).invariants == ()
    with pytest.raises(ValueError, match="error must lie between 0 and 1"):
        Reliability(full, 1.5, 0, 0)
