"""One small project and one learned run, shared by the tests of the command line."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from command_line import Cli, Ran
from pix2pred.cli.app import run


@pytest.fixture
def cli(capfd: pytest.CaptureFixture[str]) -> Cli:
    def call(*args: object) -> Ran:
        code = run([str(a) for a in args])
        captured = capfd.readouterr()
        return Ran(code, captured.out, captured.err)

    return call


@pytest.fixture(scope="session")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("project") / "stacks"
    assert run(["generate", "burger", "--seed", "70", "--tasks", "2", "--out", str(folder)]) == 0
    return folder


@pytest.fixture(scope="session")
def learned(project: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "stacks"
    assert run(["learn", str(project), "--out", str(folder)]) == 0
    return folder


@pytest.fixture
def run_copy(learned: Path, tmp_path: Path) -> Iterator[Path]:
    copy = tmp_path / "run"
    shutil.copytree(learned, copy)
    yield copy
