"""Interrupted runs, and two processes on one folder."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from cli.hostile import finish, refused, start, tree, whole
from command_line import Cli, Ran


def _wait_for(path: Path, pattern: str) -> None:
    for _ in range(6000):  # two minutes on a machine that does nothing else
        if next(path.glob(pattern), None):
            return
        time.sleep(0.02)
    raise AssertionError(f"{path}/{pattern} never came")


@pytest.fixture
def interrupted(data: Path, tmp_path: Path) -> Iterator[Ran]:
    process = start(0.3, "learn", data, "--out", tmp_path / "run")
    _wait_for(tmp_path / "run", "answers/*/*.json")
    process.send_signal(signal.SIGINT)
    yield finish(process)


def test_an_interrupted_run_resumes(cli: Cli, data: Path, done: Path, tmp_path: Path, interrupted: Ran) -> None:
    assert interrupted.code == 130 and "Traceback" not in interrupted.err
    whole(tmp_path / "run")
    assert cli("learn", data, "--out", tmp_path / "run").code == 0
    assert tree(tmp_path / "run") == tree(done)


def test_an_interrupted_run_says_that_it_can_be_resumed(interrupted: Ran) -> None:
    assert "the same command goes on" in interrupted.err


def test_two_processes_on_one_run_folder(data: Path, tmp_path: Path) -> None:
    first = start(1.5, "learn", data, "--out", tmp_path / "run")
    _wait_for(tmp_path / "run", "config.yaml")
    second = finish(start(0, "learn", data, "--out", tmp_path / "run"))
    refused(second, "another process", tmp_path / "run")
    assert finish(first).code == 0


def test_two_runs_at_once_share_a_store(cli: Cli, data: Path, done: Path, tmp_path: Path) -> None:
    store = tmp_path / "store"
    both = [start(0.05, "learn", data, "--out", tmp_path / n, "--answers", store) for n in ("a", "b")]
    assert [finish(process).code for process in both] == [0, 0]
    whole(store)
    assert len(list(store.glob("answers/*/*.json"))) == len(list(done.glob("answers/*/*.json")))
    for name in ("a", "b"):
        assert (tmp_path / name / "labels/traces.json").read_bytes() == (done / "labels/traces.json").read_bytes()
