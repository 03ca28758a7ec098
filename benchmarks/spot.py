"""Cleanup or Juice on a simulated Spot over gRPC and TLS: five variants, three initial states, labels by the reader.

    pix2pred generate cleanup --family new-objects --seed 0 --out data/cleanup
    pix2pred learn data/cleanup --out runs/cleanup
    python benchmarks/spot.py cleanup runs/cleanup --drift 0.05 --out spot-cleanup.json

Every task is also worked on without gRPC and walking, by the same program text, to compare the first plans. Whether the
goal is reached is read from the simulator afterwards; the robot's own outcome stands beside it. Cells that are in
``--out`` already are not run again.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import Any

from pix2pred.api import load_solver
from pix2pred.domains.home.domain import HomeDomain
from pix2pred.execution import Solver
from pix2pred.registry import REGISTRY
from pix2pred.robots.acting import Unwatched, act
from pix2pred.robots.robot import RobotMemory
from pix2pred.robots.simulated import SimulatedRobot
from pix2pred.robots.simulator.faults import Fault
from pix2pred.robots.simulator.server import Login, SpotServer
from pix2pred.robots.simulator.settings import Traits
from pix2pred.robots.simulator.spot import SimulatedSpot
from pix2pred.robots.spot.credentials import Credentials
from pix2pred.robots.spot.finding import ByBridge
from pix2pred.robots.spot.robot import Hand, Spot
from pix2pred.robots.spot.session import Address, SpotSession
from pix2pred.robots.spot.settings import Deadlines, SpotSettings
from pix2pred.robots.spot.skills import cleanup, juice
from pix2pred.runs.folder import RunFolder

FAMILIES = ("new-objects", "new-background", "more-objects", "novel-goal-1", "novel-goal-2")
STATES = 3
REPERTOIRES = {"cleanup": cleanup.REPERTOIRE, "juice": juice.REPERTOIRE}
PATIENT = SpotSettings(deadlines=Deadlines(*[90.0] * 8), poll=0.02, estop_timeout=90.0)
"""Measured on a busy machine: what is waited for comes, or a fault ends it."""


def cell(domain: HomeDomain, solver: Solver, family: str, index: int, faults: list[str]) -> dict[str, Any]:
    task = domain.tasks(family, 0, index + 1)[index]
    plain = act(SimulatedRobot(domain.environment(task.task, task.simulator)), task.task, solver, Unwatched())
    traits = Traits(pace=20.0, lease_patience=90.0)
    with tempfile.TemporaryDirectory() as folder:
        started, cpu = time.monotonic(), time.process_time()
        simulated = SimulatedSpot(
            lambda: domain.roaming(family, 0, index), traits, [Fault.read(f) for f in faults], seed=index
        )
        server = SpotServer(simulated, Path(folder) / "robot.pem", Login("user", "benchmark"))
        try:
            address = Address("127.0.0.1", server.port, str(server.certificate))
            session = SpotSession(address, Credentials("user", "benchmark"), PATIENT)
            outlines = ByBridge(session, "simulated-segmentation")
            hand = Hand(REPERTOIRES[domain.name], solver.model.vocabulary)
            robot = Spot("spot", session, outlines, task.task.objects, hand, RobotMemory(Path(folder) / "map.json"))
            run = act(robot, task.task, solver, Unwatched())
            world = simulated.body.around.world  # type: ignore[attr-defined]  # the judge looks behind the robot
            reached = all(domain.rules.holds(world, atom) for atom in task.task.goal)
            safe = simulated.body.stowed and not simulated.body.powered and not simulated.body.leases.owner
        finally:
            server.close()
    return {
        "family": family, "index": index, "reached": reached, "safe": safe, "same plan": plain.plan == run.plan,
        "without gRPC": plain.as_dict(), "over gRPC": run.as_dict(),
        "seconds": round(time.monotonic() - started, 1), "cpu seconds": round(time.process_time() - cpu, 1),
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("domain", choices=sorted(REPERTOIRES))
    parser.add_argument("run", type=Path)
    parser.add_argument("--drift", type=float, default=0.05)
    parser.add_argument("--fault", action="append", default=[])
    parser.add_argument("--family", action="append")
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    solver, _ = load_solver(RunFolder(args.run), "portfolio", closed_loop=True)
    domain = REGISTRY.domain(args.domain)
    assert isinstance(domain, HomeDomain), "a domain in whose worlds a robot walks"
    done: list[dict[str, Any]] = json.loads(args.out.read_text()) if args.out.exists() else []
    for family in args.family or FAMILIES:
        for index in range(STATES):
            if any(d["family"] == family and d["index"] == index for d in done):
                continue
            done.append(cell(domain, solver, family, index, [f"drift:{args.drift:g}", *args.fault]))
            args.out.write_text(json.dumps(done, indent=1) + "\n")
            print(family, index, "reached" if done[-1]["reached"] else "not reached", done[-1]["over gRPC"]["outcome"])
    good, same = sum(d["reached"] for d in done), sum(d["same plan"] for d in done)
    safe = sum(d["safe"] for d in done)
    print(f"{good} of {len(done)} reached, {same} with the plan made without gRPC, {safe} left safe")


if __name__ == "__main__":
    main()
