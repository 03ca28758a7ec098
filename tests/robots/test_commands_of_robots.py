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

import numpy as np
import pytest

PASSWORD = "planted-s3cret-7f1c"
PROGRAM = [sys.executable, "-c", "from pix2pred.cli import main; main()"]
SECRETS = {"BOSDYN_CLIENT_USERNAME": "user", "BOSDYN_CLIENT_PASSWORD": PASSWORD}
PATIENCE = 60.0
"""Seconds after which a test gives up waiting for what should have happened long ago."""


SPOT = pytest.mark.extra("bosdyn.client", "pyapriltags", extra="spot")
SIM = pytest.mark.extra("mujoco", extra="sim")


@pytest.fixture
def served(tmp_path: Path) -> Iterator[dict[str, Any]]:
    """A simulated Spot in a process of its own, in the scene that the written run is for."""
    command = [*PROGRAM, "robot", "simulate", "--index", "2", "--out", str(tmp_path / "spot"), "--pace", "20", "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=os.environ | SECRETS) as process:
        assert process.stdout is not None
        try:
            told: dict[str, Any] = json.loads(process.stdout.readline())
            yield told
        finally:
            process.send_signal(signal.SIGINT)
            assert process.wait(PATIENCE) == 0, "Ctrl-C ends it in peace"


def at(served: dict[str, Any]) -> list[str]:
    return ["127.0.0.1", "--port", str(served["port"]), "--certificate", served["certificate"]]


@SPOT
@SIM
def test_a_task_is_interrupted_and_gone_on_with_through_the_command_line(
    tmp_path: Path, served: dict[str, Any]
) -> None:
    from robots.written_run import write_run

    run, home = write_run(tmp_path / "run"), tmp_path / "home"
    home.mkdir()
    command = [
        *PROGRAM, "robot", "run", str(run), "--robot", f"spot:127.0.0.1:{served['port']}",
        "--certificate", served["certificate"], "--task", served["task"], "--yes", "--json",
    ]  # fmt: skip
    environment = os.environ | SECRETS | {"HOME": str(home)}
    session = run / "robot" / Path(served["task"]).name / "session.json"
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    ) as process:
        _until(lambda: session.exists() and bool(json.loads(session.read_text())["under_way"]))
        process.send_signal(signal.SIGINT)
        said, errors = process.communicate(timeout=PATIENCE)
    assert said, errors
    stopped = json.loads(said.splitlines()[-1])
    assert process.returncode == 1 and stopped["outcome"] == "stopped", errors
    assert stopped["under_way"].startswith("PickFromTop(robot, eraser")
    assert left(served) == {"owner": "", "powered": False, "stowed": True}

    ran = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=4 * PATIENCE)
    done = json.loads(ran.stdout.splitlines()[-1])
    assert ran.returncode == 0 and done["outcome"] == "goal", ran.stdout + ran.stderr
    assert "WipeAndContinueHoldingEraser" in done["skills"][-1]["action"] and done["under_way"] == ""
    assert left(served) == {"owner": "", "powered": False, "stowed": True}
    written = [f.read_bytes() for f in tmp_path.rglob("*") if f.is_file()]
    assert len(written) > 10
    assert not any(PASSWORD.encode() in text for text in written)
    assert PASSWORD not in said + errors + ran.stdout + ran.stderr


def left(served: dict[str, Any]) -> dict[str, Any]:
    """How the robot was left: whose it is, whether its motors are on, whether its arm is put away."""
    import bosdyn.client

    sdk = bosdyn.client.create_standard_sdk("test", cert_resource_glob=served["certificate"])
    robot = sdk.create_robot("127.0.0.1")
    robot.update_secure_channel_port(served["port"])
    robot.authenticate("user", PASSWORD)
    state = robot.ensure_client("robot-state").get_robot_state()
    (lease,) = robot.ensure_client("lease").list_leases()
    hand = state.manipulator_state
    return {
        "owner": lease.lease_owner.client_name,
        "powered": state.power_state.motor_power_state == state.power_state.STATE_ON,
        "stowed": hand.stow_state == hand.STOWSTATE_STOWED,
    }


@SPOT
@SIM
def test_a_map_is_made_while_the_robot_turns(tmp_path: Path, served: dict[str, Any]) -> None:
    from pix2pred.domains.home.roaming.tags import TAGS
    from pix2pred.robots.localising.tag_map import TagMap

    file = tmp_path / "map.json"
    command = [*PROGRAM, "robot", "map", *at(served), "--out", str(file), "--turn", "--json"]
    refused = subprocess.run(command, capture_output=True, text=True, env=os.environ | SECRETS, timeout=PATIENCE)
    assert refused.returncode == 2 and "nothing was moved" in refused.stderr and not file.exists()
    command += ["--yes", "--looks", "5"]
    ran = subprocess.run(command, capture_output=True, text=True, env=os.environ | SECRETS, timeout=2 * PATIENCE)
    assert ran.returncode == 0, ran.stderr
    told = json.loads(ran.stdout.splitlines()[-1])
    made, true = TagMap.load(file), {tag.number: tag for tag in TAGS}
    assert told["looks"] == 5 and sorted(made.tags) == told["tags"] and len(told["tags"]) >= 4
    for number, pose in made.tags.items():  # the robot starts at the room's origin
        assert float(np.linalg.norm(pose.at - true[number].at)) < 0.03, number
    assert left(served) == {"owner": "", "powered": False, "stowed": True}


@SPOT
@SIM
def test_check_says_what_there_is_to_know_and_changes_nothing(served: dict[str, Any]) -> None:
    command = [*PROGRAM, "robot", "check", *at(served), "--json"]
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


@SPOT
@SIM
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
