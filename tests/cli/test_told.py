"""What a newcomer is told: a useless model, a photo on which nothing happened, folders that moved, runs that differ."""

from __future__ import annotations

import io
import json
import shutil
import sys
from pathlib import Path
from typing import Any

import pytest

import cli.hostile_lamps as lamps
from cli.hostile import Model, edit, refused, said, tree
from command_line import Cli
from pix2pred.report import load_contents
from pix2pred.runs.folder import RunFolder
from pix2pred.vlm.offline.prompt_format import asked_atoms


def robust(data: Path) -> None:
    """The learner that needs no threshold, instead of the published one, whose default ends selection at once here."""
    edit(data / "domain.yaml", "operators: cluster-and-intersect", "operators: robust")


@pytest.fixture
def photo(tmp_path: Path) -> Path:
    path = tmp_path / "table.png"
    path.write_bytes(lamps.png(0, shade=47))
    return path


def test_a_useless_model_is_told_so_in_the_terminal_the_run_and_the_report(
    cli: Cli, model: Model, data: Path, tmp_path: Path
) -> None:
    ran = cli("learn", data, "--out", tmp_path / "run")
    assert ran.code == 0
    assert "Verdict: do not rely on this world model yet." in ran.out
    assert "No candidate was tried" in ran.out and "j_threshold = 2,000" in ran.out
    assert "Press (Op0) needs nothing" in ran.out
    metrics = json.loads((tmp_path / "run/metrics.json").read_text())
    assert len(metrics["verdict"]) == 2
    page = (tmp_path / "run/report.html").read_text()
    assert "Do not rely on this world model yet." in page and "No candidate was tried" in page
    assert [str(c) for c in load_contents(RunFolder(tmp_path / "run")).verdict] == metrics["verdict"]


def test_check_says_when_selection_would_end_before_it_began(cli: Cli, data: Path) -> None:
    ran = cli("check", data)
    assert ran.code == 0 and "selection would end before it began" in ran.out and "J is 12" in ran.out
    robust(data)
    assert "before it began" not in cli("check", data).out


def test_a_plan_says_which_of_its_steps_nobody_can_vouch_for(
    cli: Cli, model: Model, data: Path, done: Path, photo: Path
) -> None:
    ran = cli("plan", done, "--task", data / "tasks/t0")
    assert ran.code == 0 and "doubt: step 1, Press: its operator needs nothing" in " ".join(ran.out.split())
    assert json.loads((done / "plans/t0/plan.json").read_text())["doubts"][0].startswith("step 1, Press")
    assert "Doubt." in (done / "plans/t0/plan.html").read_text()


def test_a_photo_and_a_goal_are_enough_for_a_plan(cli: Cli, model: Model, done: Path, photo: Path) -> None:
    model(label=lambda request: _blind(request))
    ran = cli("plan", done, "--photo", photo, "--goal", "Done(l2)", "--json")
    assert ran.code == 0, ran.err
    assert [step["action"] for step in ran.json["plan"]] == ["Press(robby, l2)"]
    ran = cli("plan", done, "--photo", photo, "--goal", "Done(new)", "--thing", "new:lamp", "--thing", "robby")
    assert ran.code == 0 and "Press: robby, new" in ran.out


def test_a_second_goal_for_a_photo_keeps_the_first_plan(cli: Cli, model: Model, done: Path, photo: Path) -> None:
    model(label=lambda request: _blind(request))

    def planned(goal: str, *options: object) -> tuple[str, Any]:
        ran = cli("plan", done, "--photo", photo, "--goal", goal, *options, "--json")
        folder = Path(ran.json["folder"])
        return folder.name, json.loads((folder / "plan.json").read_text())["goal"]

    first, _ = planned("Done(l2)")
    assert planned("Done(l1)") == (f"{first}-2", ["Done(l1)"])
    assert planned("Done(l2)") == (first, ["Done(l2)"]), "the same task again takes its own folder"
    assert planned("not Done(l1)")[0] == f"{first}-3"
    assert planned("Done(l1)", "Done(l2)") == (f"{first}-4", ["Done(l1)", "Done(l2)"]), "several behind one option"
    ran = cli("plan", done, "--photo", photo, "--goal", "Done(l1)", "--out", done / "plans" / first)
    assert ran.code == 0 and "the plan of another task there is replaced" in ran.err


def _blind(request: Any) -> str:
    """Photos have no boxes: everything is false in them."""
    if request.purpose == "propose" or request.views[0].boxes:
        return str(lamps.sees(request))
    return "\n".join(f"* {atom}: False." for atom in asked_atoms(request.text))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([], "--task FOLDER, or --photo PHOTO --goal ATOM"),
        (["--goal", "Done(l1)"], "--goal goes with --photo"),
        (["--photo", "PHOTO"], "--goal: say what is to hold"),
        (["--photo", "PHOTO", "--goal", "Done(l9)"], "l1 (lamp), l2 (lamp), robby (robot)"),
        (["--photo", "PHOTO", "--goal", "Dome(l1)"], "did you mean 'Done'"),
        (["--photo", "PHOTO", "--goal", "Done(l1)", "--thing", "x:lapm"], "did you mean 'lamp'"),
        (["--photo", "PHOTO", "--photo", "PHOTO", "--goal", "Done(l1)"], "--photo: give 1"),
    ],
)
def test_what_is_wrong_with_a_scene_in_words_is_said(
    cli: Cli, done: Path, photo: Path, options: list[str], message: str
) -> None:
    refused(cli("plan", done, *(str(photo) if o == "PHOTO" else o for o in options)), message)


def _type(monkeypatch: pytest.MonkeyPatch, *lines: object) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("".join(f"{line}\n" for line in lines)))


def test_a_photo_on_which_nothing_happened_is_noticed(
    cli: Cli, model: Model, data: Path, done: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    boxes = "pictures: {main: {l1: [0, 0, 20, 20], l2: [20, 0, 40, 20], robby: [0, 20, 40, 30]}}\n"
    for name, lit, shade in (("same", 0, 40), ("noisy", 0, 43), ("lit", 1, 40)):
        (tmp_path / f"{name}.png").write_bytes(lamps.png(lit, shade=shade))
        (tmp_path / f"{name}.yaml").write_text(boxes + "features: {l1: [0], l2: [0]}\n")
    _type(monkeypatch, tmp_path / "same.png", "", tmp_path / "noisy.png", "", tmp_path / "lit.png", "")
    ran = cli("plan", done, "--task", data / "tasks/t0", "--interactive")
    assert ran.out.count("nothing seems to have happened") == 2
    session = json.loads((done / "plans/t0/session.json").read_text())
    assert [entry["photo"] for entry in session["executed"]] == ["lit.png"]
    _type(monkeypatch, tmp_path / "lit.png", "y", "")
    ran = cli("plan", done, "--task", data / "tasks/t0", "--interactive")
    assert ran.code == 0 and "the goal holds" in ran.out  # a person knows better


def test_a_replayed_run_works_from_anywhere_moves_and_keeps_its_pictures(
    cli: Cli, data: Path, done: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    replaying = Cli(cli.read)
    assert replaying("learn", data, "--vlm", "replay:done", "--out", "new/run").code == 0
    assert "vlm: replay:../../done" in (tmp_path / "new/run/config.yaml").read_text()
    assert "data:image/webp" in (tmp_path / "new/run/report.html").read_text()
    moved = tmp_path / "elsewhere"
    moved.mkdir()
    for name in ("new", "done"):
        shutil.move(tmp_path / name, moved / name)
    monkeypatch.chdir("/")
    assert replaying("plan", moved / "new/run", "--task", data / "tasks/t0").code == 0
    monkeypatch.chdir(moved)
    assert replaying("learn", data, "--vlm", "replay:done", "--out", "new/run").code == 0


def test_a_mailbox_is_never_made_in_the_present_folder(
    cli: Cli, done: Path, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    edit(done / "config.yaml", "vlm: offline", "vlm: mailbox:../inbox")
    edit(done / "config.yaml", "model: fake:1", "model: mailbox")
    away = tmp_path / "away"
    away.mkdir()
    monkeypatch.chdir(away)
    ran = Cli(cli.read)("solve", done, "--tasks", data)
    refused(ran)
    assert not list(away.iterdir())


def test_what_differs_from_the_run_that_is_there_is_said(cli: Cli, model: Model, data: Path, done: Path) -> None:
    ran = cli("learn", data, "--out", done, "--votes", 3)
    refused(ran, "settings.labels.votes: 1 there, 3 now", "--out", f"--answers {done}")
    edit(data / "demos/d0/demo.yaml", "Press(robby, l2)", "Press(robby, l1)")
    assert "its demonstrations, pictures or declarations were others" in said(cli("learn", data, "--out", done))


def test_operators_robust_works_as_the_readme_prints_it(cli: Cli, model: Model, data: Path, tmp_path: Path) -> None:
    config = tmp_path / "settings.yaml"
    config.write_text("operators: robust\n")
    assert cli("learn", data, "--out", tmp_path / "run", "--config", config).code == 0
    assert "operators: robust" in (tmp_path / "run/config.yaml").read_text()
    config.write_text("longest_side: 256\n")
    refused(cli("learn", data, "--out", tmp_path / "two", "--config", config), "longest_side: say whose", "proposal")
    config.write_text("robust: true\n")
    refused(cli("learn", data, "--out", tmp_path / "two", "--config", config), config, "robust")


def test_several_folders_are_learned_from_together(cli: Cli, model: Model, data: Path, tmp_path: Path) -> None:
    other = lamps.write_lamps(tmp_path / "tuesday", 2)
    ran = cli("learn", data, other, "--out", tmp_path / "run", "--json")
    assert ran.code == 0 and ran.json["demonstrations"] == 4
    names = [demo["name"] for demo in json.loads((tmp_path / "run/labels/traces.json").read_text())["demos"]]
    assert sorted(names) == ["data-d0", "data-d1", "tuesday-d0", "tuesday-d1"]
    edit(other / "domain.yaml", "- {name: plug}", "- {name: plog}")
    refused(cli("learn", data, other, "--out", tmp_path / "two"), "tuesday/domain.yaml", "declares other types")


def test_runs_are_listed_and_compared(cli: Cli, model: Model, data: Path, done: Path, tmp_path: Path) -> None:
    robust(data)
    assert cli("learn", data, "--out", tmp_path / "robust").code == 0
    listed = cli("runs", "list", tmp_path, "--json").json["runs"]
    assert [Path(row["folder"]).name for row in listed] == ["done", "robust"]
    assert "done" in cli("runs", "list", tmp_path).out
    compared = cli("runs", "compare", done, tmp_path / "robust", "--json").json
    assert {d["key"] for d in compared["settings"]} == {"settings.learning.operators"}
    shown = cli("runs", "compare", done, tmp_path / "robust").out
    assert "settings.learning.operators: cluster-and-intersect in A, robust in B" in shown
    assert "Nothing differs." in cli("runs", "compare", done, done).out
    refused(cli("runs", "compare", done, data), "holds no run")


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (["review", "x", "--port", "99999"], "--port"),
        (["learn", "x", "--out", "y", "--concurrent", "100000"], "--concurrent"),
        (["learn", "x", "--out", "y", "--max-cost", "nan"], "--max-cost"),
        (["learn", "x", "--out", "y", "--max-cost", "1e400"], "--max-cost"),
        (["learn", "x", "--out", "y", "--votes", "0"], "--votes"),
        (["select", "x", "--out", ""], "--out"),
        (["select", "x", "--out", "/"], "--out"),
        (["select", "x", "--out", "y", "--jobs", "0"], "--jobs"),
        (["plan-pddl", "x", "y", "--time-limit", "1e400"], "--time-limit"),
        (["plan-pddl", "x", "y", "--out", "/"], "--out"),
        (["generate", "foo", "--out", "y"], "there are burger, "),
        (["bench", "run", "smoke", "--jobs", "99999"], "--jobs"),
    ],
)
def test_options_are_checked_before_any_work(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, args: list[str], message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    refused(cli(*args), message)
    assert not list(tmp_path.iterdir())


def test_a_run_of_version_0_1_goes_on_with_the_defaults_of_then(
    cli: Cli, model: Model, data: Path, tmp_path: Path
) -> None:
    run, sheet = tmp_path / "run", data / "domain.yaml"
    edit(sheet, "operators: cluster-and-intersect", "operators: cluster-and-intersect, lift_types: false")
    assert cli("learn", data, "--out", run).code == 0
    config = run / "config.yaml"
    new = ("protocol:", "states_per_query:", "words_per_meaning:", "lift_types:")
    config.write_text("".join(line for line in config.read_text().splitlines(True) if not line.strip().startswith(new)))
    edit(sheet, ", operators: cluster-and-intersect, lift_types: false", "")
    before = tree(run)
    ran = cli("learn", data, "--out", run)
    assert ran.code == 0, ran.err
    assert tree(run) == before
    edit(sheet, "max_plans: 2", "max_plans: 2, tie_seed: 1")
    refused(cli("learn", data, "--out", run), "holds a run with another settings", "tie_seed")
