"""Runs ``acting.py`` for many conditions and seeds and prints the tables of docs/results.md.

    python benchmarks/acting_table.py --seeds 0 1 2 3 4 --out runs/acting

OUT/rows.jsonl has a line per run; runs that are already in it are not repeated. ``--only`` runs the conditions whose
name begins with one of the given words.
"""

from __future__ import annotations

import argparse
import json
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from acting import episodes, parser, summary

BURGERS = ("combo", "bigger", "more-stacks")


@dataclass(frozen=True)
class Condition:
    """A row of the table, and the options of ``acting.py`` that make it."""

    name: str
    options: tuple[str, ...]


def condition(name: str, kind: str, rate: float, how: str = "belief", disturb: float = 0.0) -> Condition:
    return Condition(name, ("--kind", kind, "--rate", str(rate), "--how", how, "--disturb", str(disturb)))


CONDITIONS = (
    condition("sticky per picture, 2 %", "sticky-picture", 0.02),
    condition("sticky per picture, 5 %", "sticky-picture", 0.05),
    condition("sticky per picture, 10 %", "sticky-picture", 0.1),
    condition("no errors", "sticky-picture", 0.0),
    condition("2 % and 10 % disturbed", "sticky-picture", 0.02, disturb=0.1),
    condition("open loop, asking again, independent, 5 %", "independent", 0.05, "open"),
    condition("systematic", "systematic", 1.0),
    condition("FF-Replan, no errors", "sticky-picture", 0.0, "replan"),
    condition("FF-Replan, 2 %", "sticky-picture", 0.02, "replan"),
    condition("independent, 2 %", "independent", 0.02),
    condition("independent, 5 %", "independent", 0.05),
    condition("independent, 10 %", "independent", 0.1),
    condition("votes, independent, 5 %", "independent", 0.05, "votes"),
    condition("FF-Replan, independent, 5 %", "independent", 0.05, "replan"),
    condition("sticky per object, 2 %", "sticky-object", 0.02),
    condition("sticky per object, 5 %", "sticky-object", 0.05),
    condition("unknown, 10 %", "unknown", 0.1),
    condition("no errors, 10 % disturbed", "sticky-picture", 0.0, disturb=0.1),
    condition("open loop, raw, independent, 5 %", "independent", 0.05, "open-raw"),
)


def table(rows: Sequence[dict[str, Any]]) -> str:
    """Solved of all tasks by family, with atoms asked, skills and atoms asked again per task."""
    families = sorted({r["family"] for r in rows})
    cells: dict[tuple[str, str], list[dict[str, Any]]] = defaultdict(list)
    for row in rows:
        cells[row["condition"], row["family"]].append(row)
    lines = [
        "| condition | " + " | ".join(families) + " | atoms a task | asked again | skills a solved task | suspects |"
    ]
    lines.append("|---" * (len(families) + 5) + "|")
    for one in CONDITIONS:
        mine = [r for r in rows if r["condition"] == one.name]
        if not mine:
            continue
        shares = []
        for family in families:
            found = cells[one.name, family]
            solved, tasks = sum(r["solved"] for r in found), sum(r["tasks"] for r in found)
            shares.append(f"{solved} of {tasks}" if tasks else "–")
        tasks, solved = sum(r["tasks"] for r in mine), sum(r["solved"] for r in mine)
        lines.append(
            f"| {one.name} | " + " | ".join(shares) + f" | {sum(r['atoms'] for r in mine) / tasks:.0f} | "
            f"{sum(r['again'] for r in mine) / tasks:.2f} | {sum(r['skills'] for r in mine) / max(1, solved):.1f} | "
            f"{sum(r['suspected'] for r in mine)} |"
        )
    return "\n".join(lines)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--domain", default="burger")
    options.add_argument("--families", nargs="*", default=list(BURGERS))
    options.add_argument("--seeds", nargs="*", type=int, default=[0, 1, 2, 3, 4])
    options.add_argument("--only", nargs="*", default=[""])
    options.add_argument("--out", type=Path, default=Path("runs/acting"))
    options.add_argument("--with", dest="more", nargs=argparse.REMAINDER, default=[], help="options for every run")
    given = options.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    path = given.out / "rows.jsonl"
    rows = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    done = {(r["condition"], r["family"], r["seed"]) for r in rows}
    for one in (c for c in CONDITIONS if c.name.startswith(tuple(given.only))):
        for seed in given.seeds:
            for family in given.families:
                if (one.name, family, seed) in done:
                    continue
                where = ["--domain", given.domain, "--family", family, "--seed", str(seed), "--out", str(given.out)]
                row = summary(*episodes(parser().parse_args([*where, *one.options, *given.more])))
                rows.append({"condition": one.name, "family": family, "seed": seed} | row)
                with path.open("a") as stream:
                    stream.write(json.dumps(rows[-1]) + "\n")
    print(table(rows))


if __name__ == "__main__":
    main()
