"""``distil`` on the command line: a run teaches a reader, which solves its tasks and learns more later."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from command_line import Cli
from pix2pred.report import REPORT
from pix2pred.runs.layout import EVIDENCE
from pix2pred.vlm.distilled.files import CARD, WEIGHTS

READER = "reader"


def test_a_run_teaches_a_reader_that_solves_its_tasks_and_learns_more_from_them(
    cli: Cli, run_copy: Path, project: Path, tmp_path: Path
) -> None:
    made = cli("distil", run_copy, "--out", tmp_path / READER, "--json")
    assert made.code == 0, made.err
    summary = made.json
    assert summary["made_from"]["demonstrations"] == 12 and summary["made_from"]["episodes"] == 0
    assert all(w["right"] >= 0.95 * w["answered"] for w in summary["words"]) and summary["words"]
    first = (tmp_path / READER / WEIGHTS).read_bytes()

    spec = f"cascade:{tmp_path / READER},offline"
    solved = cli("solve", run_copy, "--tasks", project, "--vlm", spec, "--closed-loop", "--json")
    assert solved.code == 0, solved.err
    said = solved.json["said_by"]
    assert said["by_reader"] > 3 * said["by_model"] and not said["drifted"]
    assert sum(count["by_reader"] for count in said["words"].values()) == said["by_reader"]
    page = (run_copy / REPORT).read_text()
    assert "Who said what" in page and "The large model contradicts the reader" not in page

    assert cli("solve", run_copy, "--tasks", project, "--closed-loop").code == 0  # the teacher itself labels
    again = cli("distil", "--resume", tmp_path / READER, "--json")
    assert again.code == 0, again.err
    assert again.json["made_from"]["episodes"] == 2
    assert again.json["made_from"]["looks"] > summary["made_from"]["looks"]
    assert (tmp_path / READER / WEIGHTS).read_bytes() != first
    told = cli("doctor", "--vlm", f"reader:{tmp_path / READER}").out
    assert "taught by offline:burger" in " ".join(told.split())


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["distil"], "name a run and a folder"),
        (["distil", "nowhere", "--out", "new"], "holds no run"),
        (["distil", "--resume", "nowhere"], "does not say what the reader was made from"),
        (["distil", "somewhere", "--resume", "nowhere"], "leave out RUN"),
    ],
)
def test_what_cannot_be_distilled_is_refused_in_one_sentence(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], why: str
) -> None:
    monkeypatch.chdir(tmp_path)
    ran = cli(*arguments)
    assert ran.code == 2 and why in ran.err and ran.err.count("\n") == 1


def test_a_run_whose_pictures_show_nothing_teaches_nothing(cli: Cli, done: Path, tmp_path: Path) -> None:
    ran = cli("distil", done, "--out", tmp_path / READER)
    assert ran.code == 2 and "nothing to teach" in ran.err and not (tmp_path / READER / CARD).exists()


def test_nothing_is_written_over_what_is_no_reader(cli: Cli, done: Path) -> None:
    ran = cli("distil", done, "--out", done.parent)
    assert ran.code == 2 and "holds no reader" in ran.err


def test_a_reader_that_knows_nothing_is_called_so(cli: Cli, run_copy: Path, tmp_path: Path) -> None:
    evidence = json.loads((run_copy / EVIDENCE).read_text())
    for picture in (picture for demo in evidence["demos"] for state in demo["states"] for picture in state):
        picture["boxes"] = {}
    (run_copy / EVIDENCE).write_text(json.dumps(evidence))
    ran = cli("distil", run_copy, "--out", tmp_path / READER, "--sure", 0.95)
    assert ran.code == 0 and "It knew nothing of what was left out" in " ".join(ran.out.split())
