"""The same rows whatever happens on the way: another run from the store, more workers, kills at random moments."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from benchmark.small import HashVLM, SmallBurger, SmallNames, run_small
from extras import need
from pix2pred.benchmark import TryOutcome, read_rows, status_of
from pix2pred.benchmark.runner import expected
from pix2pred.benchmark.sweeps import NotAvailableError, installed
from pix2pred.cli.app import run
from pix2pred.registry import REGISTRY
from pix2pred.runs.folder import RunFolderError
from pix2pred.structs.environment import Domain
from pix2pred.system.extras import MissingExtraError
from pix2pred.system.parallel import Backend, Workers
from pix2pred.vlm import VLM, StoreMode

ROOT = Path(__file__).parents[1]
KILLS = int(os.environ.get("PIX2PRED_KILLS", "4"))


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("bench") / "run"
    run_small(folder)
    return folder


def tree(folder: Path) -> dict[str, bytes]:
    return {
        str(p.relative_to(folder)): p.read_bytes()
        for p in sorted(folder.rglob("*"))
        if p.is_file() and p.name not in ("timings.json", ".lock")
    }


def test_there_is_a_row_for_every_try_and_for_every_cell_that_is_not_tried(finished: Path) -> None:
    rows = read_rows(finished / "rows.jsonl")
    tried = [r for r in rows if r.outcome.scored]
    assert len(tried) == 3 * 2 * 2 and all(r.task and r.family == "stacks" for r in tried)
    by_cell = {(r.approach, r.family, r.seed): r.outcome for r in rows if r.task is None}
    assert by_cell["vila-pure", "stacks", 0] == TryOutcome.NEEDS_MODEL
    assert by_cell["vila-pure", "kitchen", 1] == by_cell["ours", "kitchen", 0] == TryOutcome.NOT_AVAILABLE
    assert len(by_cell) == 2 + 4 * 2


class Unequipped(SmallBurger):
    def check_installed(self) -> None:
        raise ImportError("mujoco is missing; pip install 'pix2pred[sim]'")


class WithoutExtras(SmallNames):
    def domain(self, name: str) -> Domain:
        return Unequipped() if name == "burger" else super().domain(name)


def test_missing_extras_are_named_before_work_and_left_out(tmp_path: Path) -> None:
    """All families that lack something are named at once; once it is there the same run adds them."""
    said: list[str] = []
    run = run_small(tmp_path, names=WithoutExtras(), warn=said.append, seeds=[0], approaches=["ours"])
    assert {r.outcome for r in run.rows} == {TryOutcome.NOT_AVAILABLE}
    assert [sentence.partition(": ")[0] for sentence in said] == ["left out here"] * 2
    assert "stacks: domain 'burger' is not installed (mujoco is missing; pip install" in said[0]
    assert "the same command adds what was left out" in said[0] and "kitchen: domain" in said[1]
    again = run_small(tmp_path, seeds=[0], approaches=["ours"])
    assert any(r.outcome.scored for r in again.rows)


@pytest.mark.parametrize("there", [False, True])
def test_charts_that_cannot_be_drawn_are_told_of_before_the_suite_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], there: bool
) -> None:
    def stop(*_: object, **__: object) -> None:
        raise RunFolderError("the suite begins")

    monkeypatch.setattr("pix2pred.cli.bench.run_suite", stop)
    monkeypatch.setitem(sys.modules, "matplotlib", SimpleNamespace(use=print) if there else None)
    assert run(["bench", "run", "smoke", "--out", str(tmp_path / "run")]) == 2
    told, _, rest = capfd.readouterr().err.partition("the suite begins")
    assert ("charts need the extra 'plot'" in told) is not there and not rest.strip()


@pytest.mark.parametrize("name", ["kitchen", "coffee", "cleanup", "juice"])
def test_domains_that_need_an_extra_say_so(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from pix2pred.domains.physics import library

    def absent() -> None:
        raise MissingExtraError("mujoco is not installed")

    monkeypatch.setattr(library, "mujoco_library", absent)
    with pytest.raises(NotAvailableError, match=f"domain '{name}' is not installed .mujoco is not installed"):
        installed(name, REGISTRY.domain)


def test_every_failure_has_a_cause(finished: Path) -> None:
    failed = [r for r in read_rows(finished / "rows.jsonl") if r.outcome in (TryOutcome.FAILED, TryOutcome.BUDGET)]
    assert failed and all(r.cause and r.failure for r in failed)


def test_the_reader_is_never_scored_where_a_model_is_needed(finished: Path, tmp_path: Path) -> None:
    """With a model of any other name the same cell is tried."""
    run = run_small(tmp_path, vlm="hosted", approaches=["vila-pure"], seeds=[0])
    assert {r.outcome for r in run.rows if r.family == "stacks"} == {TryOutcome.FAILED}
    assert {r.failure for r in run.rows if r.family == "stacks"} == {"no plan"}


def test_a_second_run_from_the_same_store_gives_the_same_bytes_and_asks_nothing(finished: Path, tmp_path: Path) -> None:
    run_small(tmp_path, answers=finished, mode=StoreMode.REPLAY)
    assert tree(tmp_path).items() <= tree(finished).items()
    assert (tmp_path / "rows.jsonl").exists() and (tmp_path / "rows.csv").exists()


@pytest.mark.parametrize(
    "workers",
    [
        pytest.param(Workers(2), id="loky"),
        pytest.param(Workers(2, Backend.DASK), id="dask", marks=need("dask", "distributed", extra="dask")),
    ],
)
def test_the_number_and_kind_of_workers_change_nothing(finished: Path, workers: Workers, tmp_path: Path) -> None:
    run_small(tmp_path, workers=workers)
    assert tree(tmp_path) == tree(finished)


def test_killed_at_random_moments_and_resumed_the_run_has_the_same_bytes(finished: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "benchmark.small", str(tmp_path / "run"), "1"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    begin = time.monotonic()
    subprocess.run([*command[:-2], str(tmp_path / "timed"), "1"], env=environment, check=True)
    duration = time.monotonic() - begin
    rng = random.Random(7)
    for _ in range(KILLS):
        process = subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL)
        time.sleep(rng.uniform(0.1, 0.9) * duration)
        process.send_signal(signal.SIGKILL)
        process.wait()
        for path in (tmp_path / "run").rglob("*.json"):
            if not path.name.startswith("."):
                json.loads(path.read_text())
    subprocess.run(command, env=environment, check=True)
    assert tree(tmp_path / "run") == tree(finished)


def test_status_tells_how_far_an_unfinished_run_is(finished: Path, tmp_path: Path) -> None:
    copy = tmp_path / "run"
    shutil.copytree(finished, copy)
    next((copy / "cells/stacks/seed1/ours").glob("task-*.json")).unlink()
    (copy / "rows.jsonl").unlink()
    run = status_of(copy, SmallNames())
    assert (sum(r.task is not None for r in run.rows), expected(run)) == (11, 12)


class NewerReader(SmallNames):
    def vlm(self, spec: str, domain: str | None, *_: object, **__: object) -> VLM:
        return HashVLM("offline:newer")


def test_another_suite_or_another_reader_is_refused(finished: Path, tmp_path: Path) -> None:
    copy = tmp_path / "run"
    shutil.copytree(finished, copy)
    with pytest.raises(RunFolderError, match="another suite"):
        run_small(copy, tasks=3)
    with pytest.raises(RunFolderError, match="was made with offline:hash, not offline:newer"):
        run_small(copy, names=NewerReader())


@pytest.mark.parametrize(
    ("axis", "tried"),
    [
        ({"of": "demonstrations", "values": [1, 2, 3]}, {1: 2, 2: 2, 3: 0}),
        ({"of": "items", "values": [2, 13]}, {2: 2, 13: 0}),
        ({"of": "pool", "values": [1]}, {1: 2}),
        ({"of": "label-noise", "values": [0, 0.5]}, {0: 2, 0.5: 2}),
    ],
    ids=str,
)
def test_sweeps_vary_one_thing_and_say_where_they_cannot(
    axis: dict[str, object], tried: dict[float, int], finished: Path, tmp_path: Path
) -> None:
    run = run_small(tmp_path, axis=axis, approaches=["ours"], seeds=[0], answers=finished)
    stacks = [r for r in run.rows if r.family == "stacks"]
    assert {v: sum(r.value == v and r.outcome.scored for r in stacks) for v in tried} == tried
    if axis["of"] == "pool":
        learned = run.learned["stacks/1/seed0/ours"]
        assert learned["candidates"] <= 1 + 3
