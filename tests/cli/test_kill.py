"""Killed at any moment, a run resumes to the same bytes. PIX2PRED_KILLS sets how many moments are tried (default 1)."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

KILLS = int(os.environ.get("PIX2PRED_KILLS", "1"))


def _tree(folder: Path) -> dict[str, bytes]:
    return {
        str(p.relative_to(folder)): p.read_bytes()
        for p in sorted(folder.rglob("*"))
        if p.is_file() and p.name not in ("timings.json", "report.html", ".lock")
    }


def _start(*args: object) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-c", "from pix2pred.cli import main; main()", *map(str, args)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


@pytest.mark.parametrize("verb", ["learn", "solve"])
def test_a_killed_run_resumes_to_the_same_bytes(verb: str, project: Path, learned: Path, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    solve_args = ("solve", folder, "--seed", 72, "--count", 2, "--closed-loop")
    shutil.copytree(learned, folder)
    args = ("learn", project, "--out", folder) if verb == "learn" else solve_args
    if verb == "learn":
        shutil.rmtree(folder)
    begin = time.monotonic()
    assert _start(*args).wait() == 0
    duration = time.monotonic() - begin
    expected = _tree(folder)
    rng = random.Random(verb)
    for _ in range(KILLS):
        shutil.rmtree(folder)
        if verb == "solve":
            shutil.copytree(learned, folder)
        process = _start(*args)
        time.sleep(rng.uniform(0.2, 1.0) * duration)
        process.send_signal(signal.SIGKILL)
        process.wait()
        for path in folder.rglob("*.json"):
            if not path.name.startswith("."):
                assert path.read_text().rstrip().endswith(("}", "]")), f"{path} is half-written"
        assert _start(*args).wait() == 0
        assert _tree(folder) == expected
