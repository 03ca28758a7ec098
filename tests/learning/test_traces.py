"""The traces format: round trips, and every error with its JSON path."""

from __future__ import annotations

import copy
import gzip
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from learning.random_tables import POOL, SKILLS, TYPES, random_table
from pix2pred.learning import Traces, TracesError, dump_traces, load_traces
from pix2pred.structs import Atom, Label, LabelledDemo, TruthTable, Vocabulary
from pix2pred.structs.goals.opposites import contrary

WORKLOAD = Path(__file__).parents[1] / "data" / "workloads" / "more_stacks_n100_noise2.json.gz"

DOCUMENT: dict[str, Any] = {
    "format": "pix2pred-traces",
    "version": 1,
    "types": [{"name": "patty", "parent": "item"}, {"name": "item"}, {"name": "robot"}],
    "skills": [{"name": "Pick", "types": ["robot", "item"]}],
    "predicates": [
        {"name": "Holding", "types": ["robot", "item"], "kind": "given"},
        {"name": "HandEmpty", "types": [], "kind": "candidate"},
        {"name": "cooked", "types": ["patty"], "kind": "candidate", "cost": 2.5},
        {"name": "near", "types": ["robot", "patty"], "kind": "candidate"},
    ],
    "demos": [
        {
            "objects": {"robot": "robot", "patty1": "patty"},
            "goal": [["Holding", "robot", "patty1"]],
            "actions": [["Pick", "robot", "patty1"]],
            "states": [[["HandEmpty"], ["cooked", "patty1"]], [["Holding", "robot", "patty1"], ["cooked", "patty1"]]],
            "unknown": [[["near", "robot", "patty1"]], []],
        }
    ],
    "settings": {"h_pre_frac": 0.8},
}


def write(path: Path, document: object) -> Path:
    path.write_text(document if isinstance(document, str) else json.dumps(document))
    return path


def load(tmp_path: Path, document: object) -> Traces:
    return load_traces(write(tmp_path / "traces.json", document))


def message(path: Path) -> str:
    with pytest.raises(TracesError) as caught:
        load_traces(path)
    assert str(path) in str(caught.value)
    return str(caught.value)


def test_hand_worked_file(tmp_path: Path) -> None:
    traces = load(tmp_path, DOCUMENT)
    table = traces.table
    assert [p.signature for p in table.initial] == ["Holding(robot, item)"]
    assert [(c.predicate.signature, c.cost) for c in table.pool] == [
        ("HandEmpty()", 0.0), ("cooked(patty)", 2.5), ("near(robot, patty)", 2.0),
    ]  # fmt: skip
    (demo,) = table.demos
    assert [str(a) for a in demo.atoms] == ["HandEmpty()", "Holding(robot, patty1)", "cooked(patty1)",
                                            "near(robot, patty1)"]  # fmt: skip
    assert demo.values.tolist() == [
        [Label.TRUE, Label.FALSE, Label.TRUE, Label.UNKNOWN],
        [Label.FALSE, Label.TRUE, Label.TRUE, Label.FALSE],
    ]
    assert [str(a) for a in demo.actions] == ["Pick(robot, patty1)"]
    assert [str(a) for a in demo.goal] == ["Holding(robot, patty1)"]
    assert demo.name == "demo-0"
    assert [(o.name, o.type.name) for o in demo.objects] == [("patty1", "patty"), ("robot", "robot")]
    parents = [t.parent.name if t.parent else None for t in traces.vocabulary.types]
    assert parents == ["item", None, None]
    assert traces.settings == {"h_pre_frac": 0.8}
    assert [c.predicate.name for c in table.candidates()] == ["HandEmpty", "cooked"]  # near is never true


@pytest.mark.parametrize("packed", [False, True])
def test_round_trip_of_the_supplied_workload(tmp_path: Path, packed: bool) -> None:
    traces = load_traces(WORKLOAD)
    text = dump_traces(traces.vocabulary, traces.table, traces.settings)
    path = tmp_path / "again"  # what a file is shows in its first bytes, not in its name
    path.write_bytes(gzip.compress(text.encode()) if packed else text.encode())
    again = load_traces(path)
    assert again == Traces(traces.vocabulary, again.table, traces.settings)
    assert again.table == _named(traces.table)
    assert dump_traces(again.vocabulary, again.table, again.settings) == text


def _named(table: TruthTable) -> TruthTable:
    """Names given by position are written out: nothing else may change."""
    assert [d.name for d in table.demos] == [f"demo-{i}" for i in range(len(table.demos))]
    return table


@given(st.integers(0, 2**32))
@settings(max_examples=60, deadline=None)
def test_round_trip_of_random_tables_keeps_every_label(tmp_path_factory: pytest.TempPathFactory, seed: int) -> None:
    source = random_table(seed)
    rng = np.random.default_rng(seed)
    demos = tuple(
        LabelledDemo(
            d.name, d.objects, d.actions, d.goal, d.atoms,
            np.where(rng.random(d.values.shape) < 0.2, Label.UNKNOWN, d.values).astype(np.int8),
        )
        for d in source.demos
    )  # fmt: skip
    table = TruthTable(source.initial, source.pool, demos)
    path = tmp_path_factory.mktemp("traces") / "t.json"
    path.write_text(dump_traces(Vocabulary("v", TYPES, SKILLS, source.initial), table, {}))
    again = load_traces(path).table
    assert [p.signature for p in again.initial] == [p.signature for p in source.initial]
    pools = [[(c.predicate.signature, c.cost) for c in t.pool] for t in (again, source)]
    assert pools[0] == pools[1]
    for value in (Label.TRUE, Label.UNKNOWN):
        assert [_where(d, value) for d in again.demos] == [_where(d, value) for d in demos]
    assert [[str(a) for a in d.actions] for d in again.demos] == [[str(a) for a in d.actions] for d in demos]


def test_goals_with_not_and_or_are_kept(tmp_path: Path) -> None:
    source = random_table(5, 0.0)
    predicate = source.initial[0]
    first = source.demos[0]
    atom = Atom(predicate, first.objects[: predicate.arity])
    several = replace(first, goal=(contrary(atom),), alternatives=((), (atom,)))
    path = tmp_path / "t.json"
    path.write_text(dump_traces(Vocabulary("v", TYPES, SKILLS, source.initial), replace(source, demos=(several,)), {}))
    (again,) = load_traces(path).table.demos
    assert [[*map(str, g)] for g in again.goals] == [[*map(str, g)] for g in several.goals]
    path.write_text(path.read_text().replace('["not ', '["not no'))
    with pytest.raises(TracesError, match=r"goal\[0\]: predicate 'no"):
        load_traces(path)


def test_a_goal_that_can_never_hold_is_refused(tmp_path: Path) -> None:
    document = copy.deepcopy(DOCUMENT)
    atom = document["demos"][0]["goal"][0]
    document["demos"][0]["goal"].append([f"not {atom[0]}", *atom[1:]])
    path = tmp_path / "t.json"
    path.write_text(json.dumps(document))
    with pytest.raises(TracesError, match=r"goal\[\d\]: .* is to hold and not to hold"):
        load_traces(path)


def _where(demo: LabelledDemo, value: int) -> list[set[str]]:
    return [{str(demo.atoms[i]) for i in np.flatnonzero(row == value)} for row in demo.values]


def _set(*path: Any) -> Callable[[Any], None]:
    *keys, last, value = path

    def change(document: Any) -> None:
        for key in keys:
            document = document[key]
        document[last] = value

    return change


def _delete(*path: Any) -> Callable[[Any], None]:
    def change(document: Any) -> None:
        for key in path[:-1]:
            document = document[key]
        del document[path[-1]]

    return change


TWICE = DOCUMENT["predicates"][0]
ERRORS: list[tuple[Callable[[Any], None], str, str]] = [
    (_set("format", "other"), "$.format", "'pix2pred-traces', found \"other\""),
    (_set("version", 2), "$.version", "found 2"),
    (_delete("predicates"), "$.predicates", "required"),
    (_set("surprise", 1), "$.surprise", "not permitted"),
    (_set("demos", []), "$.demos", "at least one demonstration"),
    (_set("demos", {}), "$.demos", "found {}"),
    (_set("predicates", 2, "cost", float("inf")), "$.predicates[2].cost", "finite number"),
    (_set("types", 0, "parent", "itm"), "$.types", "did you mean 'item'"),
    (_set("types", 1, "parent", "patty"), "$.types", "its own ancestor"),
    (_set("types", 2, "name", "item"), "$.types", "'item' is declared twice"),
    (_set("skills", 0, "types", 1, "iten"), "$.skills[0]", "type 'iten' is not declared"),
    (_set("predicates", 2, "name", "Holding"), "$.predicates[2].name", "'Holding' is declared twice"),
    (_set("predicates", 1, "types", ["nothing"]), "$.predicates[1]", "type 'nothing'"),
    (_set("predicates", 2, "kind", "maybe"), "$.predicates[2].kind", 'found "maybe"'),
    (_set("predicates", 2, "cost", -1), "$.predicates[2].cost", "found -1"),
    (_set("predicates", 2, "name", "has space"), "$.predicates[2].name", "has space"),
    (_delete("predicates", 2, "kind"), "$.predicates[2].kind", "required"),
    (_set("demos", 0, "objects", "patty1", "paty"), "$.demos[0].objects.patty1", "did you mean 'patty'"),
    (_set("demos", 0, "goal", [["cooked", "patty1"]]), "$.demos[0].goal[0]", "cooked(patty1) is not over a given"),
    (_set("demos", 0, "goal", [[]]), "$.demos[0].goal[0]", "found []"),
    (_set("demos", 0, "actions", 0, ["Pick", "robot"]), "$.demos[0].actions[0]", "takes 2 arguments, found 1"),
    (_set("demos", 0, "actions", 0, ["Pikc", "robot", "patty1"]), "$.demos[0].actions[0]", "did you mean 'Pick'"),
    (_set("demos", 0, "actions", 0, ["Pick", "patty1", "robot"]), "$.demos[0].actions[0]", "patty1 is a patty"),
    (_set("demos", 0, "actions", 0, []), "$.demos[0].actions[0]", "found []"),
    (_set("demos", 0, "states", [[]]), "$.demos[0].states", "1 actions need 2 states, found 1"),
    (_set("demos", 0, "states", 1, 0, ["Holding", "robot"]), "$.demos[0].states[1][0]", "takes 2 arguments, found 1"),
    (_set("demos", 0, "states", 1, 0, ["Holding", "robot", "patty9"]), "$.demos[0].states[1][0]", "object 'patty9'"),
    (_set("demos", 0, "states", 0, 1, ["cooked", "robot"]), "$.demos[0].states[0][1]", "robot is a robot, not a patty"),
    (_set("demos", 0, "states", 0, 0, ["Unheard"]), "$.demos[0].states[0][0]", "predicate 'Unheard'"),
    (_set("demos", 0, "states", 0, 0, "HandEmpty"), "$.demos[0].states[0][0]", "HandEmpty"),
    (_set("demos", 0, "states", 0, 0, ["cooked", 1]), "$.demos[0].states[0][0][1]", "found 1"),
    (_set("demos", 0, "unknown", [[]]), "$.demos[0].unknown", "one entry per state"),
    (_set("demos", 0, "unknown", 1, [["near", "robot"]]), "$.demos[0].unknown[1][0]", "takes 2 arguments"),
    (_set("settings", []), "$.settings", "found []"),
]


@pytest.mark.parametrize(("change", "where", "what"), ERRORS, ids=[f"{w} {m}" for _, w, m in ERRORS])
def test_errors_name_the_path_and_the_value(
    tmp_path: Path, change: Callable[[Any], None], where: str, what: str
) -> None:
    document = copy.deepcopy(DOCUMENT)
    change(document)
    said = message(write(tmp_path / "traces.json", document))
    assert f": {where}: " in said
    assert what in said


@pytest.mark.parametrize(
    "text",
    ["", "not JSON", '{"format": ', "[" * 100_000, '{"a":' * 100_000, "\udcff", "1" * 10_000],
    ids=["empty", "prose", "cut off", "nested lists", "nested objects", "no UTF-8", "long number"],
)
def test_hostile_texts_are_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "traces.json"
    path.write_bytes(text.encode(errors="surrogateescape"))
    assert "cannot be read as JSON" in message(path)


@pytest.mark.parametrize("value", ["[]", "null", "3", '"text"'])
def test_json_that_is_no_object(tmp_path: Path, value: str) -> None:
    assert ": $: " in message(write(tmp_path / "traces.json", value))


@pytest.mark.parametrize("depth", [400, 900, 950, 970, 980, 985, 990, 995])
def test_nesting_that_json_just_accepts_is_a_traces_error(tmp_path: Path, depth: int) -> None:
    text = json.dumps(DOCUMENT).replace('[["Holding", "robot", "patty1"]]', "[" * depth + "]" * depth, 1)
    message(write(tmp_path / "traces.json", text))


@pytest.mark.parametrize("kept", [0, 1, 10, 11, 100, -9, -1])
def test_truncated_gzip(tmp_path: Path, kept: int) -> None:
    path = tmp_path / "traces.json.gz"
    path.write_bytes(WORKLOAD.read_bytes()[:kept])
    message(path)


@pytest.mark.parametrize("position", [0, 3, 40, 2000, -6, -2])
def test_corrupted_gzip(tmp_path: Path, position: int) -> None:
    packed = bytearray(WORKLOAD.read_bytes())
    packed[position] ^= 0xFF
    path = tmp_path / "traces.json.gz"
    path.write_bytes(packed)
    message(path)


def test_missing_file_and_folder(tmp_path: Path) -> None:
    assert "cannot be read" in message(tmp_path / "nowhere.json")
    assert "cannot be read" in message(tmp_path)


def test_hostile_chain_of_ancestors(tmp_path: Path) -> None:
    document = copy.deepcopy(DOCUMENT)
    document["types"] += [{"name": f"t{i}", "parent": f"t{i + 1}"} for i in range(3000)] + [{"name": "t3000"}]
    path = write(tmp_path / "traces.json", document)
    try:
        assert len(load_traces(path).vocabulary.types) == 3004
    except TracesError as error:
        assert "$.types" in str(error)  # too deep is a fair answer, a RecursionError is not


def test_pool_predicates_of_the_random_tables_are_all_written(tmp_path: Path) -> None:
    source = random_table(3)
    table = TruthTable(source.initial, source.pool, source.demos)
    document = json.loads(dump_traces(Vocabulary("v", TYPES, SKILLS, source.initial), table, {"max_plans": 3}))
    kinds = {p["name"]: p["kind"] for p in document["predicates"]}
    assert kinds == {p.name: "given" for p in source.initial} | {c.predicate.name: "candidate" for c in source.pool}
    assert {c.predicate for c in source.pool} <= set(POOL)
    assert load(tmp_path, document).settings == {"max_plans": 3}


def test_confidence_comes_back_and_is_checked(tmp_path: Path) -> None:
    source = random_table(3)
    rng = np.random.default_rng(3)
    demos = []
    for d in source.demos:
        sure = np.where(rng.random(d.values.shape) < 0.5, rng.random(d.values.shape).round(2), np.nan)
        demos.append(LabelledDemo(d.name, d.objects, d.actions, d.goal, d.atoms, d.values, sure.astype(np.float32)))
    table = TruthTable(source.initial, source.pool, tuple(demos))
    text = dump_traces(Vocabulary("v", TYPES, SKILLS, source.initial), table, {})
    (tmp_path / "t.json").write_text(text)
    again = load_traces(tmp_path / "t.json").table

    def known(demo: LabelledDemo) -> dict[tuple[int, str], float]:
        assert demo.confidence is not None
        places = np.argwhere(np.isfinite(demo.confidence))
        return {(int(t), str(demo.atoms[i])): round(float(demo.confidence[t, i]), 4) for t, i in places}

    assert [known(d) for d in again.demos] == [known(d) for d in demos]
    document = json.loads(text)
    document["demos"][0]["confidence"][0][0][1] = 1.5
    with pytest.raises(TracesError, match=r"demos\[0\].confidence\[0\]\[0\]\[1\]"):
        load(tmp_path, document)
    document["demos"][0]["confidence"] = []
    with pytest.raises(TracesError, match="must have one entry per state"):
        load(tmp_path, document)
