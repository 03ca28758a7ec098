"""Learn and solve every burger family with the offline reader, several seeds, and print the table of docs/results.md.

    python benchmarks/families.py --seeds 5 --count 10 --out runs/families

Each (family, seed) is one ``pix2pred demo`` in its own process; runs that are already in OUT are resumed.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections import Counter
from pathlib import Path
from statistics import mean, stdev
from typing import Any

from joblib import Parallel, delayed

FAMILIES = ("more-stacks", "bigger", "combo")


def demo(family: str, seed: int, count: int, out: Path) -> dict[str, Any]:
    command = [sys.executable, "-c", "from pix2pred.cli import main; main()", "demo", "--family", family, "--seed",
               str(seed), "--count", str(count), "--out", str(out), "--json"]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode == 2:
        raise SystemExit(done.stderr)
    result: dict[str, Any] = json.loads(done.stdout.strip().splitlines()[-1])
    return result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("runs/families"))
    arguments = parser.parse_args()
    jobs = [(family, seed) for family in FAMILIES for seed in range(arguments.seeds)]
    results = Parallel(n_jobs=arguments.jobs, verbose=1)(
        delayed(demo)(family, seed, arguments.count, arguments.out) for family, seed in jobs
    )
    by_job = dict(zip(jobs, results, strict=True))
    print("| family | solved | mean of 10 ± sd | failures | selected | operators | candidates |")
    print("|---|---|---|---|---|---|---|")
    for family in FAMILIES:
        rows = [by_job[family, seed] for seed in range(arguments.seeds)]
        counts = [row["solve"]["solved"] for row in rows]
        failures: Counter[str] = sum((Counter(row["solve"]["failures"]) for row in rows), Counter())
        sets = Counter(", ".join(row["learn"]["selected"]) for row in rows)
        print(
            f"| {family} | {sum(counts)} of {arguments.seeds * arguments.count} | {mean(counts):.1f} ± "
            f"{stdev(counts) if len(counts) > 1 else 0:.1f} | {dict(failures) or 'none'} | "
            + "; ".join(f"{names} ({n}x)" for names, n in sets.most_common())
            + f" | {sorted({row['learn']['operators'] for row in rows})} | "
            f"{min(row['learn']['candidates'] for row in rows)}-{max(row['learn']['candidates'] for row in rows)} |"
        )
    print(f"\nReader: {by_job[jobs[0]]['learn']['labels_from']}")


if __name__ == "__main__":
    main()
