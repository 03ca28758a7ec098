"""Faults of a simulated Spot at random moments of a short Cleanup task: is the end named, the robot safe, and then?

    PYTHONPATH=tests python benchmarks/spot_faults.py --out spot-faults.json

The task, taking an eraser and wiping, is worked on with a world model written by hand, over gRPC and TLS. A fault
strikes at a moment drawn from 1 to MOMENTS (commands and pictures are counted); those with a number hold all the time.
Then what struck is put right, and the same session is gone on with: in truth, is the goal reached? ``killed`` is the
program itself, by kill -9; seconds are counted until the robot stands still and until its power is off. The last line
is one JSON object. Cells that are in ``--out`` already are not run again.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from pix2pred.demos import write_task
from pix2pred.robots.robot import Outcome
from pix2pred.robots.simulator.body import SimulatedBody
from pix2pred.robots.simulator.server import SpotServer
from pix2pred.robots.simulator.settings import Traits
from pix2pred.structs.environment import SimulatedTask
from robots.simulated_spots import DOMAINS, PASSWORD, PATIENT, served
from robots.written_run import FAMILY, INDEX, put_right, work, write_run

MOMENTS = 55
"""Commands and pictures of the task when nothing goes wrong: 58."""

ENDS = {
    "lease-lost": {Outcome.LEASE_LOST},
    "estop": {Outcome.ESTOPPED},
    "fall": {Outcome.FALLEN},
    "battery-empty": {Outcome.BATTERY_EMPTY},
    "camera-timeout": {Outcome.CAMERA_SILENT},
    "grasp-miss:0.2": {Outcome.GOAL, Outcome.GAVE_UP},
    "blocked:0.2": {Outcome.GOAL, Outcome.GAVE_UP, Outcome.BLOCKED},
    "drift:0.05": {Outcome.GOAL},
    "slow": {Outcome.GOAL},
}
"""How the work may end under each fault. One that struck after the last skill leaves the goal reached."""

LATE = {Outcome.GOAL}
UNSTOWED = {"lease-lost", "estop", "fall", "battery-empty"}
"""Faults after which the robot does not obey any more: its arm may be where it was, but it does not move."""

ANSWER = 10.0
"""Seconds that a silent camera is waited for here; a busy machine takes some for its pictures."""

KILLS = 5
STOPS_WITHIN, OFF_WITHIN = 5.0, 13.0
"""Seconds of patience with a silent client: with its lease, and with its stop button until the power is cut."""

PROGRAM = [sys.executable, "-c", "from pix2pred.cli import main; main()"]


class Bench:
    """One task, and a solver whose model was written by hand."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.domain = folder, DOMAINS["cleanup"]
        self.made = self.domain.tasks(FAMILY, 0, INDEX + 1)[INDEX]

    def run(self, server: SpotServer, run: Path, answer: float = PATIENT.answer) -> tuple[str, str]:
        """Work on the task; the outcome's name, or the exception that came through."""
        try:
            done = work(server, run, self.made.task, answer)
        except Exception as error:  # which ones come through is what is measured
            return f"{type(error).__name__}: {error}", ""
        return str(done.outcome), done.detail

    def reached(self, body: SimulatedBody) -> bool:
        """Whether the goal holds in truth."""
        world = body.around.world  # type: ignore[attr-defined]  # the judge looks behind the robot
        return all(self.domain.rules.holds(world, atom) for atom in self.made.task.goal)

    def fault(self, fault: str, seed: int, moment: int) -> dict[str, Any]:
        """One fault."""
        text = f"{fault}@{moment}" if ":" not in fault and fault != "slow" else fault
        with tempfile.TemporaryDirectory(dir=self.folder) as made:
            folder = Path(made)
            run = write_run(folder / "run")
            with served(folder, "cleanup", FAMILY, INDEX, seed=0, faults=[text], robot_seed=seed) as server:
                body = server.spot.body
                outcome, detail = self.run(server, run, ANSWER if fault == "camera-timeout" else PATIENT.answer)
                before = {
                    "outcome": outcome, "detail": detail, "moments": server.spot.faults.moments,
                    "named": outcome in ENDS[fault] | LATE,
                    "lease": body.leases.owner == "" or (fault == "lease-lost" and body.leases.owner == "tablet"),
                    "arm": body.stowed or (fault in UNSTOWED and not body.moving),
                    "stowed": body.stowed,
                }  # fmt: skip
                put_right(server)
                again, why = self.run(server, run)
                return before | {"again": again, "why": why, "resumed": again == Outcome.GOAL and self.reached(body)}

    def kill(self, seed: int, moment: int) -> dict[str, Any]:
        """The program is killed when the robot has had so many commands and pictures."""
        with tempfile.TemporaryDirectory(dir=self.folder) as made:
            folder = Path(made)
            run = write_run(folder / "run")
            write_task(folder, self.domain.vocabulary(FAMILY), SimulatedTask(self.made.task, {}))
            with served(folder, "cleanup", FAMILY, INDEX, traits=Traits(pace=2.0), robot_seed=seed) as server:
                body = server.spot.body
                command = [
                    *PROGRAM, "robot", "run", str(run), "--robot", f"spot:127.0.0.1:{server.port}", "--certificate",
                    str(server.certificate), "--task", str(folder / "tasks" / self.made.task.name), "--yes", "--json",
                ]  # fmt: skip
                secrets = {"BOSDYN_CLIENT_USERNAME": "user", "BOSDYN_CLIENT_PASSWORD": PASSWORD}
                with subprocess.Popen(command, stdout=subprocess.PIPE, env=os.environ | secrets) as process:
                    came = until(lambda: server.spot.faults.moments >= moment or process.poll() is not None, 300.0)
                    process.kill()
                began = time.monotonic()
                still = until(lambda: not (body.moving or body.reaching), 60.0)
                off = until(lambda: not body.powered, 60.0)
                took = {"still after": round(still, 1), "off after": round(off, 1), "moment": moment, "came": came}
                in_time = still <= STOPS_WITHIN + 1.0 and time.monotonic() - began <= OFF_WITHIN + 1.0
                again, why = self.run(server, run)
                return took | {
                    "in time": in_time,
                    "again": again,
                    "why": why,
                    "resumed": again == Outcome.GOAL and self.reached(body),
                }


def until(holds: Callable[[], bool], longest: float) -> float:
    """Wait; gives the seconds it took."""
    began = time.monotonic()
    while not holds() and time.monotonic() - began < longest:
        time.sleep(0.02)
    return time.monotonic() - began


def summary(done: list[dict[str, Any]]) -> dict[str, Any]:
    """How many cells were as they should be, by fault and altogether."""
    checks = ("named", "lease", "arm", "in time", "resumed")
    kinds = sorted({d["fault"] for d in done})
    rows = {k: [d for d in done if d["fault"] == k] for k in kinds} | {"all": done}
    return {
        k: {"cells": len(of)} | {c: sum(d[c] for d in of if c in d) for c in checks if any(c in d for d in of)}
        for k, of in rows.items()
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--moments", type=int, default=10, help="how often each fault is tried")
    parser.add_argument("--kills", type=int, default=KILLS)
    parser.add_argument("--fault", action="append", choices=[*ENDS, "killed"])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    done: list[dict[str, Any]] = json.loads(args.out.read_text()) if args.out.exists() else []
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(Path(folder))
        for number in range(max(args.moments, args.kills)):
            for rank, fault in enumerate([*ENDS, "killed"]):
                if args.fault and fault not in args.fault:
                    continue
                if number >= (args.kills if fault == "killed" else args.moments):
                    continue
                if any((d["fault"], d["number"]) == (fault, number) for d in done):
                    continue
                moment = int(np.random.default_rng((args.seed, rank, number)).integers(1, MOMENTS + 1))
                cell = bench.kill(number, moment) if fault == "killed" else bench.fault(fault, number, moment)
                done.append({"fault": fault, "number": number, "moment": moment} | cell)
                args.out.write_text(json.dumps(done, indent=1) + "\n")
                print(json.dumps(done[-1]), flush=True)
    print(json.dumps(summary(done)))


if __name__ == "__main__":
    main()
