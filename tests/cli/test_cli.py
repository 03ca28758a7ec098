"""The verbs end to end: results, exit codes, messages, resuming."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
import yaml

from command_line import Cli
from pix2pred.learning import load_traces
from pix2pred.planning.pddl.names import described
from pix2pred.planning.pddl.read import read_domain
from pix2pred.structs.formats.world_model import dump_model, load_model


def _tree(folder: Path, *but: str) -> dict[str, bytes]:
    return {
        str(p.relative_to(folder)): p.read_bytes()
        for p in sorted(folder.rglob("*"))
        if p.is_file() and p.name not in (*but, "timings.json", "report.html", ".lock")
    }


def test_learning_finds_a_cooked_and_a_hand_free_predicate(learned: Path) -> None:
    metrics = json.loads((learned / "metrics.json").read_text())
    assert metrics["candidates"] >= 100 and metrics["operators"] == 7
    assert len(metrics["selected"]) == 2
    selection = json.loads((learned / "selection.json").read_text())
    assert selection["steps"][0]["added"] is None
    assert selection["steps"][-1]["J"] <= 2000


def test_solving_unseen_tasks(cli: Cli, run_copy: Path) -> None:
    ran = cli("solve", run_copy, "--seed", 71, "--count", 2, "--json")
    assert ran.code == 0, ran.err
    assert ran.json["solved"] == ran.json["tasks"] == 2
    assert [len(e["steps"]) for e in ran.json["episodes"]] == [25, 29]
    assert (run_copy / "solve" / "burger-more-stacks-seed71" / "summary.json").exists()


def test_learning_again_resumes_from_stored_answers_and_changes_no_byte(
    cli: Cli, project: Path, run_copy: Path
) -> None:
    before = _tree(run_copy)
    ran = cli("learn", project, "--out", run_copy, "--json")
    assert ran.code == 0, ran.err
    assert {"proposed", "candidates", "selected", "operators", "seconds"} <= set(ran.json)
    queries = json.loads((run_copy / "timings.json").read_text())["queries"]
    assert all(row["queries"] == row["from_store"] for row in queries.values())
    assert _tree(run_copy) == before


def test_replay_asks_nothing_and_says_what_is_missing(cli: Cli, project: Path, run_copy: Path) -> None:
    assert cli("learn", project, "--out", run_copy, "--mode", "replay").code == 0
    victim = next((run_copy / "answers").rglob("*.json"))
    victim.unlink()
    ran = cli("learn", project, "--out", run_copy, "--mode", "replay")
    assert ran.code == 2 and "has no answer" in ran.err and "Traceback" not in ran.err


def test_a_damaged_answer_is_named(cli: Cli, project: Path, run_copy: Path) -> None:
    victim = next((run_copy / "answers").rglob("*.json"))
    victim.write_text("{")
    ran = cli("learn", project, "--out", run_copy)
    assert ran.code == 2 and victim.name in ran.err


def test_other_settings_need_another_folder(cli: Cli, project: Path, run_copy: Path, tmp_path: Path) -> None:
    config = tmp_path / "config.yaml"
    config.write_text("learning: {h_pre_frac: 0.9}\n")
    ran = cli("learn", project, "--out", run_copy, "--config", config)
    assert ran.code == 2 and "settings" in ran.err


@pytest.mark.parametrize(
    ("text", "message"),
    [("learning: {h_pre_frac: 3}", "h_pre_frac"), ("lerning: {}", "lerning"), ("- 1", "expected settings")],
)
def test_bad_settings_are_named(cli: Cli, project: Path, tmp_path: Path, text: str, message: str) -> None:
    config = tmp_path / "config.yaml"
    config.write_text(text)
    ran = cli("learn", project, "--out", tmp_path / "run", "--config", config)
    assert ran.code == 2 and message in ran.err and str(config) in ran.err


def test_simulator_state_changes_no_label_and_no_plan(cli: Cli, project: Path, run_copy: Path, tmp_path: Path) -> None:
    bare = tmp_path / "stacks"
    shutil.copytree(project, bare)
    for file in bare.glob("tasks/*/simulator.json"):
        file.unlink()
    with_it = cli("solve", run_copy, "--tasks", project, "--plan-only", "--json")
    without = cli("solve", run_copy, "--tasks", bare, "--plan-only", "--json")
    assert with_it.code == without.code == 0
    assert with_it.json == without.json
    ran = cli("solve", run_copy, "--tasks", bare)
    assert ran.code == 2 and "simulator.json" in ran.err and "--plan-only" in ran.err


def test_model_and_labels_load_back_equal(learned: Path) -> None:
    text = (learned / "model" / "world_model.json").read_text()
    model = load_model(learned / "model" / "world_model.json")
    assert dump_model(model) == text
    assert load_traces(learned / "labels" / "traces.json").table.candidates()
    domain = read_domain((learned / "model" / "domain.pddl").read_text())
    assert domain.distinct
    for ours, theirs in zip(described(model).operators, domain.operators, strict=True):
        assert str(ours) == str(theirs) and ours.support == theirs.support


def test_a_task_with_a_broken_label_source_is_called_by_its_cause(cli: Cli, run_copy: Path) -> None:
    """A model without operators cannot plan: the cause is a missing plan, not a label."""
    path = run_copy / "model" / "world_model.json"
    model = json.loads(path.read_text())
    model["operators"] = []
    path.write_text(json.dumps(model))
    ran = cli("solve", run_copy, "--count", 1, "--json")
    assert ran.code == 1
    assert ran.json["failures"] == {"no plan": 1}


@pytest.mark.parametrize(
    "verb", ["demo", "generate", "check", "learn", "solve", "plan", "select", "runs list", "mailbox", "import bits"]
)
def test_help_shows_examples_each_on_a_line_of_its_own(cli: Cli, verb: str) -> None:
    ran = cli(*verb.split(), "--help")
    assert ran.code == 0 and "For example:" in ran.out
    assert all(line.count(f"pix2pred {verb} ") <= 1 for line in ran.out.splitlines())
    assert any(line.strip().startswith(f"• pix2pred {verb} ") for line in ran.out.splitlines())
    assert "--no-json" not in ran.out


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (["learn"], "name the data and a run folder"),
        (["solve", "nowhere"], "holds no run"),
        (["generate", "burgerr", "--out", "x"], "did you mean 'burger'"),
        (["generate", "burger", "--family", "biger", "--out", "x"], "did you mean 'bigger'"),
        (["learn", "nowhere", "--out", "x"], "nowhere"),
        (["frobnicate"], "frobnicate"),
    ],
)
def test_bad_input_is_one_clear_message(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, args: list[str], message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    ran = cli(*args)
    assert ran.code == 2 and message in " ".join(ran.err.split()) and "Traceback" not in ran.err


def test_check_reports_file_and_line(cli: Cli, project: Path, tmp_path: Path) -> None:
    assert cli("check", project).code == 0
    copy = tmp_path / "copy"
    shutil.copytree(project, copy)
    file = sorted(copy.glob("demos/*/demo.yaml"))[0]
    lines = file.read_text().splitlines()
    at = next(i for i, line in enumerate(lines) if "Pick(robot, patty1)" in line)
    lines[at] = lines[at].replace("patty1", "patyt1")
    file.write_text("\n".join(lines) + "\n")
    ran = cli("check", copy, "--json")
    assert ran.code == 2
    assert any(p["line"] == at + 1 and "patty1" in p["message"] for p in ran.json["problems"])


def test_two_processes_cannot_work_in_one_run_folder(cli: Cli, project: Path, run_copy: Path) -> None:
    from pix2pred.runs.folder import RunFolder

    with RunFolder(run_copy).locked():
        ran = cli("learn", project, "--out", run_copy)
    assert ran.code == 2 and "another process" in ran.err


def test_a_folder_that_is_no_run_is_left_alone(cli: Cli, project: Path, tmp_path: Path) -> None:
    names = [".backup.20240131", ".note.1.2.part", ".zcompdump-host-5.3999999", "precious.txt"]
    for name in names:
        (tmp_path / name).write_text("keep me")
    ran = cli("learn", project, "--out", tmp_path)
    assert ran.code == 2 and "not a run folder" in ran.err
    assert sorted(p.name for p in tmp_path.iterdir()) == names


def test_settings_are_saved_resolved(learned: Path) -> None:
    config = yaml.safe_load((learned / "config.yaml").read_text())
    assert config["settings"]["learning"]["j_threshold"] == 2000
    assert config["settings"]["labels"]["double_check"] is True
