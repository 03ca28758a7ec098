"""``robot run`` on a simulated episode, which needs no extra: asked before anything moves, and by programs."""

from __future__ import annotations

import io
import json
from pathlib import Path

import pytest

from command_line import Cli


def test_a_program_gets_one_object_with_outcome_skills_and_replans(cli: Cli, run_copy: Path) -> None:
    ran = cli("robot", "run", run_copy, "--robot", "sim:burger/more-stacks/1", "--yes", "--json")
    told = ran.json
    assert told["outcome"] in ("goal", "gave-up", "no-plan") and isinstance(told["replans"], int)
    assert ran.code == (0 if told["outcome"] == "goal" else 1)
    session = json.loads((Path(told["folder"]) / "session.json").read_text())
    assert session["skills"] == told["skills"] and "holding" in session
    assert len(list((Path(told["folder"]) / "looks").iterdir())) == len(told["skills"])


def test_nothing_moves_when_a_person_says_no(cli: Cli, run_copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("n\n"))
    ran = cli("robot", "run", run_copy, "--robot", "sim:burger/more-stacks/1")
    assert ran.code == 1 and "declined: nothing was moved" in ran.out
    monkeypatch.setattr("sys.stdin", io.StringIO("y\nn\n"))
    ran = cli("robot", "run", run_copy, "--robot", "sim:burger/more-stacks/1")
    assert ran.code == 1 and "no skill was run" in ran.out


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--robot", "ur5:host", "--yes"], "no robot 'ur5:host'"),
        (["--robot", "sim:burger/more-stacks/1", "--json"], "--json needs --yes"),
        (["--robot", "sim:burger/of-course/1", "--yes"], "of-course"),
        (["--robot", "spot:host", "--yes"], "--task"),
    ],
)
def test_what_cannot_work_is_said_in_one_sentence(cli: Cli, run_copy: Path, options: list[str], said: str) -> None:
    ran = cli("robot", "run", run_copy, *options)
    assert ran.code == 2 and said in ran.err and ran.err.count("\n") == 1
