"""How a folder of PDDL domains fares: read, solved, valid, seconds and plan length, beside other planners.

    python benchmarks/public_pddl.py DIR [--planners quick,fast-downward,pyperplan] [--time-limit 30] [--only WORD]
        [--sample 3] [--results FILE] [--pieces 300]

A problem is every .pddl file that defines one; its domain is the file of the folder that is called ``domain.pddl``,
like the problem with ``domain`` in its name (``p01-domain.pddl``, ``domain_p01.pddl``) or like its beginning, or that
alone defines the problem's domain. Every planner runs in a process of its own, for so many seconds of processor time,
starting included.
``fast-downward`` (its configuration ``lama-first``) and ``pyperplan`` come with the extra ``planners`` and read the
files themselves. All plans are checked by the code behind ``pix2pred validate``. ``--planners ""`` only reads.

Large collections are sampled (``--sample 3``: the first problem of every folder and those after one and two thirds)
and run in pieces: with ``--results`` every outcome is kept in a file, what is there is not run again, and after
``--pieces`` seconds of processor time the program ends, to be started again.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import re
import resource
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from importlib.util import find_spec
from pathlib import Path

from pix2pred.cli.pddl_files import text_of
from pix2pred.planning.pddl.check import check_plan
from pix2pred.planning.pddl.read import PddlDomain, PddlProblem, read_domain, read_problem
from pix2pred.planning.pddl.steps import read_plan
from pix2pred.registry import planner_names
from pix2pred.system.errors import Pix2predError

_DEFINES = re.compile(r"\(\s*define\s*\(\s*(domain|problem)\s+([^\s()]+)", re.IGNORECASE)
_DOMAIN_OF = re.compile(r"\(\s*:domain\s+([^\s()]+)", re.IGNORECASE)
_OURS = "from pix2pred.cli import main; main()"


@dataclass(frozen=True)
class Case:
    """A problem file with its domain file."""

    domain: Path
    problem: Path


@dataclass(frozen=True)
class Outcome:
    """How a planner fared: ``found`` is solved, late, none or invalid; length of the plan and processor seconds.

    A plan is late when all processes of a planner together took more than the limit, which the system sets for each.
    """

    found: str
    length: int
    seconds: float


def cases(folder: Path) -> Iterator[Case]:
    """The problems below ``folder`` for which there is a domain file, sorted."""
    domains: dict[Path, str] = {}
    problems: dict[Path, str] = {}
    for path in sorted(folder.rglob("*.pddl")):
        text = path.read_bytes().decode("latin-1")
        code = re.sub(r";[^\n]*", "", text)
        defined = _DEFINES.search(code)
        if defined and defined[1].lower() == "domain":
            domains[path] = defined[2].lower()
        elif defined and (of := _DOMAIN_OF.search(code)):
            problems[path] = of[1].lower()
    for path, name in problems.items():
        here = [d for d in domains if d.parent == path.parent] or [d for d in domains if d.parent == path.parent.parent]
        alike = [d for d in here if re.sub(r"[-_]*domain[-_]*", "", d.stem) == path.stem]
        plain = [d for d in here if d.stem == "domain"]
        begun = [d for d in here if d not in plain and path.stem.startswith(d.stem.removesuffix("domain"))]
        same = [d for d in here if domains[d] == name]
        found = alike or plain or begun or (same if len(same) == 1 else [])
        if found:
            yield Case(found[0], path)


def command(planner: str, case: Case, plan: Path) -> list[str]:
    """What runs ``planner`` so that its plan is written to ``plan``."""
    files = [str(case.domain), str(case.problem)]
    if planner == "fast-downward":
        spec = find_spec("up_fast_downward")
        assert spec is not None and spec.origin is not None, "the extra 'planners' brings Fast Downward"
        program = Path(spec.origin).parent / "downward" / "fast-downward.py"
        return [sys.executable, str(program), "--alias", "lama-first", "--plan-file", str(plan), *files]
    if planner == "pyperplan":
        script = "import sys; from pyperplan.__main__ import main; main()"
        return [sys.executable, "-c", script, "-H", "hff", "-s", "gbf", *files]
    return [sys.executable, "-c", _OURS, "plan-pddl", *files, "--planner", planner, "--out", str(plan)]


def run(planner: str, case: Case, domain: PddlDomain, problem: PddlProblem, limit: int) -> Outcome:
    """Run ``planner`` in a folder of its own and check what it wrote."""
    with tempfile.TemporaryDirectory() as folder:
        plan = Path(folder) / "plan"
        copy = Case(Path(folder) / "domain.pddl", Path(folder) / "problem.pddl")
        for source, target in ((case.domain, copy.domain), (case.problem, copy.problem)):
            target.write_bytes(source.read_bytes())
        limited = ["sh", "-c", f'ulimit -t {limit}; exec "$@"', "sh", *command(planner, copy, plan)]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        with contextlib.suppress(subprocess.TimeoutExpired):
            subprocess.run(limited, capture_output=True, cwd=folder, check=False, timeout=10 * limit)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        written = plan if plan.exists() else Path(f"{copy.problem}.soln")
        if not written.exists():
            return Outcome("none", 0, seconds)
        try:
            checked = check_plan(domain, problem, read_plan(text_of(written), domain, problem))
        except Pix2predError:
            return Outcome("invalid", 0, seconds)
        valid = "late" if seconds > limit else "solved"
        return Outcome(valid if checked.valid else "invalid", len(checked.steps), seconds)


def sampled(found: Iterable[Case], count: int) -> list[Case]:
    """Of every folder ``count`` problems at even distances, the first one included; numbers in names are ordered."""
    folders: dict[Path, list[Case]] = {}
    for case in found:
        folders.setdefault(case.problem.parent, []).append(case)
    chosen = []
    for inside in folders.values():
        inside.sort(key=lambda c: [int(w) if w.isdigit() else w for w in re.split(r"(\d+)", c.problem.name)])
        places = dict.fromkeys(i * len(inside) // count for i in range(count))
        chosen += [inside[i] for i in places]
    return chosen


class Results:
    """Outcomes by planner and problem, kept in a file with one JSON object a line where one is named."""

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._known: dict[tuple[str, str], Outcome] = {}
        for line in path.read_text().splitlines() if path and path.exists() else ():
            row = json.loads(line)
            self._known[row["planner"], row["problem"]] = Outcome(row["found"], row["length"], row["seconds"])

    def get(self, planner: str, problem: str) -> Outcome | None:
        """What is known of ``planner`` on ``problem``."""
        return self._known.get((planner, problem))

    def add(self, planner: str, problem: str, outcome: Outcome) -> None:
        """Keep ``outcome``."""
        self._known[planner, problem] = outcome
        if self._path:
            with self._path.open("a") as file:
                file.write(json.dumps({"planner": planner, "problem": problem, **asdict(outcome)}) + "\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--planners", default="quick", help=f"fast-downward, pyperplan, {', '.join(planner_names())}")
    parser.add_argument("--time-limit", type=int, default=30)
    parser.add_argument("--only", default="", help="only problems whose path matches this regular expression")
    parser.add_argument("--sample", type=int, default=0, help="only so many problems of every folder")
    parser.add_argument("--results", type=Path, help="a file with outcomes, to which new ones are added")
    parser.add_argument("--pieces", type=float, default=float("inf"), help="end after so many processor seconds")
    parser.add_argument("--where", default="", help="only problems that this planner solved, by the results")
    args = parser.parse_args()
    results = Results(args.results)
    totals: Counter[tuple[str, str]] = Counter()
    spent = 0.0
    found = list(cases(args.folder))
    for case in sampled(found, args.sample) if args.sample else found:
        name = str(case.problem.relative_to(args.folder))
        if not re.search(args.only, name):
            continue
        solved = results.get(args.where, name)
        if args.where and (solved is None or solved.found != "solved"):
            continue
        totals["problems", ""] += 1
        planners = [p for p in args.planners.split(",") if p]
        if spent > args.pieces or not planners or any(results.get(p, name) is None for p in planners):
            try:
                domain = read_domain(text_of(case.domain))
                problem = read_problem(text_of(case.problem), domain)
            except Pix2predError as error:
                print(f"{name}  not read: {error}", flush=True)
                continue
        totals["read", ""] += 1
        for planner in planners:
            outcome = results.get(planner, name)
            if outcome is None and spent > args.pieces:
                totals["not run", planner] += 1
                continue
            if outcome is None:
                outcome = run(planner, case, domain, problem, args.time_limit)
                spent += outcome.seconds
                results.add(planner, name, outcome)
            totals[outcome.found, planner] += 1
            row = f"{outcome.found:<8} {outcome.length:>4} steps {outcome.seconds:>7.2f} s"
            print(f"{name!s:<40} {planner:<14} {row}", flush=True)
    for (what, planner), count in sorted(totals.items()):
        print(f"{what:<8} {planner:<14} {count}")


if __name__ == "__main__":
    main()
