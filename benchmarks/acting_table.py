"""Runs ``acting.py`` for many conditions and seeds and prints the tables of docs/results.md.

    python benchmarks/acting_table.py --seeds 0 1 2 3 4 --out runs/acting
    python benchmarks/acting_table.py --domain cleanup --families new-objects --only sticky-picture --out runs/acting

One process: what is learned, drawn and read for a seed serves all its conditions. OUT/rows.jsonl has a line per
domain, family, seed and condition; those that are in it are not repeated. ``--only`` runs the conditions whose name
begins with one of the given words (``--list`` prints the names); ``--minutes`` begins nothing new after that much time.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from acting import KINDS, Ground, episodes, parser, summary

Row = dict[str, Any]
BURGERS = ("combo", "bigger", "more-stacks")
DISTURBED = ("burger",)
"""Domains that can be disturbed."""

RATES = (0.02, 0.03, 0.05, 0.07, 0.1)
"""Shares of wrong labels; the last but one and the second are between those of the requirements."""


@dataclass(frozen=True)
class Condition:
    """A row of the table, and the options of ``acting.py`` that make it."""

    name: str
    options: tuple[str, ...]
    disturbed: bool = False


def condition(kind: str, rate: float, how: str = "belief", disturb: float = 0.0) -> Condition:
    words = [kind if rate else "no errors", f"{rate:.0%}" if rate not in (0.0, 1.0) else ""]
    words += [f"{disturb:.0%} disturbed" if disturb else "", how if how != "belief" else ""]
    options = ("--kind", kind, "--rate", str(rate), "--how", how, "--disturb", str(disturb))
    return Condition(", ".join(filter(None, words)), options, disturb > 0)


CONDITIONS = (
    condition("sticky-picture", 0.0),
    *(condition(kind, rate) for kind in KINDS if kind != "systematic" for rate in RATES),
    condition("systematic", 1.0),
    condition("sticky-picture", 0.0, disturb=0.1),
    condition("sticky-picture", 0.02, disturb=0.1),
    condition("sticky-picture", 0.05, disturb=0.1),
    condition("independent", 0.05, "open"),
    condition("independent", 0.05, "open-raw"),
    condition("independent", 0.05, "votes"),
    condition("sticky-picture", 0.05, "votes"),
    condition("sticky-picture", 0.0, "replan"),
    condition("sticky-picture", 0.02, "replan"),
    condition("independent", 0.05, "replan"),
    condition("sticky-picture", 0.05, "replan"),
)


def table(rows: Sequence[Row]) -> str:
    """Solved of all tasks by family, with atoms asked, atoms asked again and skills per task, and suspects."""
    families = list(dict.fromkeys((r["domain"], r["family"]) for r in rows))
    lines = ["| condition | seeds | " + " | ".join(map(" ".join, families)) + " | atoms | again | skills | suspects |"]
    lines.append("|---" * (len(families) + 6) + "|")
    for one in CONDITIONS:
        mine = [r for r in rows if r["condition"] == one.name]
        if not mine:
            continue
        shares = []
        for family in families:
            found = [r for r in mine if (r["domain"], r["family"]) == family]
            shares.append(f"{sum(r['solved'] for r in found)} of {sum(r['tasks'] for r in found)}" if found else "–")
        tasks, solved = sum(r["tasks"] for r in mine), sum(r["solved"] for r in mine)
        suspected, named = sum(r["suspected"] for r in mine), sum(r["named"] for r in mine)
        lines.append(
            f"| {one.name} | {', '.join(map(str, sorted({r['seed'] for r in mine})))} | {' | '.join(shares)} | "
            f"{sum(r['atoms'] for r in mine) / tasks:.0f} | {sum(r['again'] for r in mine) / tasks:.2f} | "
            f"{sum(r['skills'] for r in mine) / max(1, solved):.1f} | {suspected} ({named} right) |"
        )
    return "\n".join(lines)


def missing(given: argparse.Namespace, rows: Sequence[Row]) -> Iterator[Row]:
    """Runs what ``rows`` lack of what was asked for, seed by seed."""
    done = {(r["condition"], r["domain"], r["family"], r["seed"]) for r in rows}
    begun = time.monotonic()
    for seed, family in product(given.seeds, given.families):
        ground: Ground | None = None
        for one in (c for c in CONDITIONS if c.name.startswith(tuple(given.only))):
            impossible = one.disturbed and given.domain not in DISTURBED
            if impossible or (one.name, given.domain, family, seed) in done:
                continue
            if time.monotonic() - begun > 60 * given.minutes:
                return
            where = ["--domain", given.domain, "--family", family, "--seed", str(seed), "--count", str(given.count)]
            arguments = parser().parse_args([*where, "--out", str(given.out), *one.options, *given.more])
            ground, start = ground or Ground.of(arguments), time.process_time()
            result = summary(*episodes(arguments, ground))
            seconds = round(time.process_time() - start, 1)
            yield {
                "condition": one.name,
                "domain": given.domain,
                "family": family,
                "seed": seed,
                "cpu": seconds,
            } | result


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--domain", default="burger")
    options.add_argument("--families", nargs="*", default=list(BURGERS))
    options.add_argument("--seeds", nargs="*", type=int, default=[0, 1, 2, 3, 4])
    options.add_argument("--count", type=int, default=10, help="tasks per seed")
    options.add_argument("--only", nargs="*", default=[""])
    options.add_argument("--minutes", type=float, default=float("inf"))
    options.add_argument("--list", action="store_true")
    options.add_argument("--out", type=Path, default=Path("runs/acting"))
    options.add_argument("--with", dest="more", nargs=argparse.REMAINDER, default=[], help="options for every run")
    given = options.parse_args()
    if given.list:
        print("\n".join(c.name for c in CONDITIONS))
        return
    given.out.mkdir(parents=True, exist_ok=True)
    path = given.out / "rows.jsonl"
    rows = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    for row in missing(given, rows):
        rows.append(row)
        with path.open("a") as stream:
            stream.write(json.dumps(row) + "\n")
        print(
            row["condition"], row["family"], row["seed"], row["solved"], row["failures"] or "", row["cpu"], flush=True
        )
    print(table([r for r in rows if r["domain"] == given.domain]))


if __name__ == "__main__":
    main()
