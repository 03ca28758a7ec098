"""A step that failed is marked, told, kept in files, and teaches no effect; what skills contradict is noticed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from command_line import Cli
from demos.photo_files import photo
from pix2pred.demos import inspect_project, read_project
from pix2pred.predicates import LabelSettings, label_demos, labeller_for
from pix2pred.predicates.initial import local_values
from pix2pred.predicates.prompt import action_text
from pix2pred.structs import Label
from pix2pred.structs.formats.traces import TracesError, dump_traces, load_traces
from predicates.scripted import ScriptedVLM

DOMAIN = """\
format: pix2pred-domain
version: 1
name: cups
types: [{name: cup}, {name: robot}]
objects: {a: {type: cup}, b: {type: cup}, robby: {type: robot}}
skills:
- {name: Pick, types: [robot, cup]}
- {name: Put, types: [robot, cup]}
predicates:
- {name: Away, types: [cup], source: human}
- name: Held
  types: [cup]
  source: skills
  set_by: [{skill: Pick, args: [1]}]
  cleared_by: [{skill: Put, args: [1]}]
"""


def project(folder: Path, actions: list[str], given: list[str] | None = None) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "domain.yaml").write_text(DOMAIN)
    for name, cup in (("one", "a"), ("two", "b")):
        demo = folder / "demos" / name
        for t in range(len(actions) + 1):
            photo(demo / f"images/{t}/main.jpg", seed=t)
        listed = given or ["[]"] * len(actions) + ["['Away(X)']"]
        lines = ["format: pix2pred-demo", "version: 1", "objects: [a, b, robby]", "goal: ['Away(X)']", "actions:"]
        lines += [f"- {action}" for action in actions] + ["states:"] + [f"- given: {g}" for g in listed]
        (demo / "demo.yaml").write_text("\n".join(lines).replace("X", cup) + "\n")
    return folder


def warnings(folder: Path) -> list[str]:
    found = inspect_project(folder)
    assert not found.problems, found.problems
    return [str(w) for w in found.warnings if "demo.yaml" in str(w) and "look the same" not in str(w)]


@pytest.fixture
def cli(capfd: pytest.CaptureFixture[str]) -> Cli:
    return Cli(lambda: (read := capfd.readouterr()) and (read.out, read.err))


RETRIED = ["Pick(robby, X) failed", "Pick(robby, X)", "Put(robby, X)"]


@pytest.mark.parametrize("mark", ["failed", "FAILED", "(failed)"])
def test_a_failed_step_sets_nothing_and_is_told(tmp_path: Path, mark: str) -> None:
    (one, _) = read_project(project(tmp_path, [RETRIED[0].replace("failed", mark), *RETRIED[1:]])).demos
    assert [a.failed for a in one.actions] == [True, False, False]
    assert str(one.actions[0]) == "Pick(robby, a) failed"
    assert action_text(one.actions[0]) == "Pick[robby:robot, a:cup] (failed)"
    assert action_text(one.actions[1]) == "Pick[robby:robot, a:cup]"
    held = next(p for p in read_project(tmp_path).vocabulary.initial if p.name == "Held")(one.objects[0])
    assert local_values(held, one.states, one.actions) == [Label.FALSE, Label.FALSE, Label.TRUE, Label.FALSE]


def selected(cli: Cli, folder: Path, operators: str) -> dict[str, Any]:
    """What ``select`` learns from the project's labels, written as traces; none of them comes from a model."""
    made = read_project(folder)
    labeller = labeller_for(ScriptedVLM([]), LabelSettings())
    table = label_demos(made.demos, made.vocabulary.initial, [], labeller).table
    traces, out = folder / "traces.json", folder / "selection.json"
    traces.write_text(dump_traces(made.vocabulary, table, {"operators": operators}))
    read = load_traces(traces).table
    assert [d.actions for d in read.demos] == [d.actions for d in made.demos]
    ran = cli("select", traces, "--out", out)
    assert ran.code == 0, ran.err
    document: dict[str, Any] = json.loads(out.read_text())
    return document


@pytest.mark.parametrize("operators", ["robust", "cluster-and-intersect"])
def test_a_failed_step_teaches_no_effect_and_makes_no_plan_longer(tmp_path: Path, cli: Cli, operators: str) -> None:
    """What is learned, and its worth, are those of the same demonstrations without the failed step."""
    marked, without, unmarked = (
        selected(cli, project(tmp_path / str(n), actions), operators)
        for n, actions in enumerate((RETRIED, RETRIED[1:], [RETRIED[1], *RETRIED[1:]]))
    )
    names = ("parameters", "preconditions", "add", "delete", "skill")
    kept = [[{n: op[n] for n in names} for op in found["operators"]] for found in (marked, without, unmarked)]
    assert kept[0] == kept[1] and [op["skill"][0] for op in kept[0]] == ["Pick", "Put"]
    assert marked["steps"] == without["steps"] != unmarked["steps"]


@pytest.mark.parametrize("failed", [[3], [-1], ["x"]])
def test_traces_name_failures_that_are_no_actions(tmp_path: Path, failed: list[Any]) -> None:
    made = read_project(project(tmp_path, RETRIED))
    table = label_demos(made.demos, made.vocabulary.initial, [], labeller_for(ScriptedVLM([]), LabelSettings())).table
    document = json.loads(dump_traces(made.vocabulary, table, {}))
    assert document["demos"][0]["failed"] == [0]
    document["demos"][0]["failed"] = failed
    (tmp_path / "t.json").write_text(json.dumps(document))
    with pytest.raises(TracesError, match=r"demos\[0\].failed|demos.0.failed"):
        load_traces(tmp_path / "t.json")


CONTRADICTIONS = {
    "forgotten to put": (["Pick(robby, X)", "Pick(robby, X)", "Put(robby, X)"], "sets Held(a), which holds already"),
    "never picked": (["Put(robby, X)", "Pick(robby, X)", "Put(robby, X)"], "clears Held(a), which does not hold"),
    "put twice": (["Pick(robby, X)", "Put(robby, X)", "Put(robby, X)"], "clears Held(a), which does not hold"),
}


@pytest.mark.parametrize("kind", CONTRADICTIONS)
def test_declared_effects_that_contradict_the_steps_are_noticed(tmp_path: Path, kind: str) -> None:
    actions, message = CONTRADICTIONS[kind]
    found = warnings(project(tmp_path, actions))
    assert any(message in w and "write 'failed' behind it" in w and "one/demo.yaml" in w for w in found), found


def test_what_fits_is_not_warned_of(tmp_path: Path) -> None:
    assert not warnings(project(tmp_path / "retried", RETRIED))
    given = ["['Held(X)']", "[]", "[]", "['Away(X)']"]
    assert not warnings(project(tmp_path / "held", ["Put(robby, X)", "Pick(robby, X)", "Put(robby, X)"], given))


def test_labels_that_contradict_what_is_declared_are_noticed(tmp_path: Path) -> None:
    given = ["[]", "['Held(X)']", "['Held(X)']", "['Away(X)']"]
    found = warnings(project(tmp_path, RETRIED, given))
    assert any("demo.yaml:11: " in w and "Held(a) is listed here, and by the skills" in w for w in found), found
    assert len(found) == 2, "once in each demonstration: after the second step it does hold"
