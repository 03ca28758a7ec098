"""``pix2pred robot`` as people and programs use it: a process that serves, one that works, and one that is killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

PASSWORD = "planted-s3cret-7f1c"
PROGRAM = [sys.executable, "-c", "from pix2pred.cli import main; main()"]
SECRETS = {"BOSDYN_CLIENT_USERNAME": "user", "BOSDYN_CLIENT_PASSWORD": PASSWORD}
PATIENCE = 60.0
"""Seconds after which a test gives up waiting for what should have happened long ago."""


@pytest.fixture
def served(tmp_path: Path) -> Iterator[dict[str, Any]]:
    command = [*PROGRAM, "robot", "simulate", "--out", str(tmp_path / "spot"), "--pace", "20", "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=os.environ | SECRETS) as process:
        assert process.stdout is not None
        try:
            told: dict[str, Any] = json.loads(process.stdout.readline())
            yield told
        finally:
            process.send_signal(signal.SIGINT)
            assert process.wait(PATIENCE) == 0, "Ctrl-C ends it in peace"


@pytest.mark.extra("bosdyn.client", "pyapriltags", extra="spot")
@pytest.mark.extra("mujoco", extra="sim")
def test_check_says_what_there_is_to_know_and_changes_nothing(served: dict[str, Any]) -> None:
    command = [*PROGRAM, "robot", "check", "127.0.0.1", "--port", str(served["port"]),
               "--certificate", served["certificate"], "--json"]  # fmt: skip
    ran = subprocess.run(command, capture_output=True, text=True, env=os.environ | SECRETS, timeout=PATIENCE)
    found = json.loads(ran.stdout.splitlines()[-1])
    assert ran.returncode == 0 and found["ready"], ran.stderr
    said = {f["what"]: f["said"] for f in found["findings"]}
    assert "spot-SIM-0001" in said["robot"] and said["battery"] == "83 %" and said["lease"] == "free"
    assert said["tags"].startswith("sees ") and "+2.5 s" in said["clock"]
    assert PASSWORD not in ran.stdout + ran.stderr
    wrong = subprocess.run(
        command, capture_output=True, text=True, timeout=PATIENCE,
        env=os.environ | SECRETS | {"BOSDYN_CLIENT_PASSWORD": f"no-{PASSWORD}"},
    )  # fmt: skip
    assert wrong.returncode == 2 and "does not know this user" in wrong.stderr and PASSWORD not in wrong.stderr
    assert (Path(served["task"]) / "task.yaml").exists()


@pytest.mark.extra("bosdyn.client", "pyapriltags", extra="spot")
@pytest.mark.extra("mujoco", extra="sim")
def test_a_robot_whose_program_is_killed_stops_by_itself(tmp_path: Path) -> None:
    from pix2pred.robots.simulator.settings import Traits
    from robots.simulated_spots import served as served_here

    slow = Traits(pace=0.02, lease_patience=4.0)
    with served_here(tmp_path, traits=slow) as server:
        walker = Path(__file__).with_name("walker.py")
        command = [sys.executable, str(walker), str(server.port), str(server.certificate)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=os.environ | SECRETS) as process:
            assert process.stdout is not None and process.stdout.readline() == "walking\n"
            body = server.spot.body
            _until(lambda: body.moving)
            process.kill()
        start = body.place
        _until(lambda: not body.moving and not body.standing)
        _until(lambda: not body.powered)
        assert body.leases.stale and body.place.distance(start) < 0.5
        stood = body.place
        assert body.leases.acquire("somebody else") is not None
        assert body.place == stood


def _until(holds: Any) -> None:
    until = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < until, "it did not happen"
        time.sleep(0.01)


def test_without_the_extra_one_sentence_says_what_to_install(tmp_path: Path) -> None:
    hidden = (
        "import sys; sys.modules['bosdyn.client'] = None; from pix2pred.cli.app import run; sys.exit(run(sys.argv[1:]))"
    )
    command = [sys.executable, "-c", hidden, "robot", "check", "127.0.0.1"]
    ran = subprocess.run(command, capture_output=True, text=True, env=os.environ | SECRETS, timeout=PATIENCE)
    assert ran.returncode == 2 and ran.stderr.count("\n") == 1
    assert "pip install " in ran.stderr and "[spot]'" in ran.stderr
