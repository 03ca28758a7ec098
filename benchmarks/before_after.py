"""CPU seconds of whole commands, of this code and of another checkout, by turns in one run.

    python benchmarks/before_after.py ../before/src --tries 3

Commands: ``--version``, ``--help``, ``plan-pddl`` of a published problem, ``check`` and ``learn --vlm offline`` of a
generated burger project, which both read, and the report of what each has learned, with its small pictures made anew.
Seconds are user and system time of the command with everything it starts; medians, and the ratio to the other checkout.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

HERE = Path(__file__).parents[1]
PDDL = HERE / "tests/data/pddl"
COMMAND = "import sys; from pix2pred.cli import main; sys.exit(main())"
REPORT = """
import sys, pathlib
from pix2pred.report import write_report
from pix2pred.runs.folder import RunFolder
write_report(RunFolder(pathlib.Path(sys.argv[1])))
"""


def cpu_seconds(source: Path, code: str, *arguments: str | Path) -> float:
    """What a new Python takes for ``code`` with the package in ``source``."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = {name: text for name, text in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    command = [sys.executable, "-c", code, *map(str, arguments)]
    subprocess.run(command, env={**environment, "PYTHONPATH": str(source)}, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def learned(source: Path, project: Path, out: Path) -> float:
    shutil.rmtree(out, ignore_errors=True)
    return cpu_seconds(source, COMMAND, "learn", project, "--vlm", "offline", "--out", out)


def reported(source: Path, out: Path) -> float:
    shutil.rmtree(out / "previews", ignore_errors=True)
    return cpu_seconds(source, REPORT, out)


def commands(folder: Path) -> Mapping[str, Callable[[Path, Path], float]]:
    """The commands by name; each takes a checkout's sources and the folder of what it has learned."""
    project, problem = folder / "project", (PDDL / "coffee-domain.pddl", PDDL / "coffee-1.pddl")
    return {
        "--version": lambda source, out: cpu_seconds(source, COMMAND, "--version"),
        "--help": lambda source, out: cpu_seconds(source, COMMAND, "--help"),
        "plan-pddl": lambda source, out: cpu_seconds(source, COMMAND, "plan-pddl", *problem),
        "check": lambda source, out: cpu_seconds(source, COMMAND, "check", project),
        "learn": lambda source, out: learned(source, project, out),
        "report": reported,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=Path, help="folder that holds the other checkout's package: .../src")
    parser.add_argument("--tries", type=int, default=3)
    parser.add_argument("--only", nargs="+", help="names of commands")
    arguments = parser.parse_args()
    sources = {"before": arguments.before.resolve(), "now": HERE / "src"}
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        burger = ("generate", "burger", "--family", "combo", "--seed", "1", "--out", folder / "project")
        cpu_seconds(sources["before"], COMMAND, *burger)
        print("| command | before | now | ratio |\n|---|---|---|---|")
        for name, run in commands(folder).items():
            if arguments.only and name not in arguments.only:
                continue
            tries = [[run(source, folder / which) for which, source in sources.items()] for _ in range(arguments.tries)]
            before, now = map(statistics.median, zip(*tries, strict=True))
            print(f"| {name} | {before:.2f} | {now:.2f} | {now / before:.2f} |", flush=True)


if __name__ == "__main__":
    main()
