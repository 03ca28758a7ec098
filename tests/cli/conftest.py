"""One small project and one learned run, shared by the tests of the command line."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import cli.hostile_lamps as lamps
from cli.hostile import Model
from command_line import Cli
from pix2pred.cli.app import run


@pytest.fixture
def cli(capfd: pytest.CaptureFixture[str]) -> Cli:
    return Cli(lambda: (read := capfd.readouterr()) and (read.out, read.err))


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


@pytest.fixture
def model(cli: Cli) -> Model:
    """Call it to put a scripted model behind ``--vlm``; gives the model."""

    def set_model(**answers: Any) -> Any:
        fake = lamps.Fake(**answers)
        cli.registry = lamps.OneModel(fake)
        return fake

    set_model()
    return set_model


@pytest.fixture
def data(tmp_path: Path) -> Path:
    return Path(lamps.write_lamps(tmp_path / "data"))


@pytest.fixture
def done(cli: Cli, model: Model, data: Path, tmp_path: Path) -> Path:
    """A finished run of the lamps."""
    ran = cli("learn", data, "--out", tmp_path / "done")
    assert ran.code == 0, ran.err
    return tmp_path / "done"
