"""A picture of what ``distil.py`` measured: shares answered, and questions asked, over the number of episodes.

python benchmarks/distil_curves.py runs/distil/rows.jsonl --out distil.png
"""

from __future__ import annotations

import argparse
import json
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

Rows = Sequence[dict[str, Any]]


def draw(axes: Axes, rows: Rows, part: str, whole: str) -> None:
    """``part`` as a share of ``whole``, summed over seeds: a line for every family and share of wrong labels."""
    families = sorted({(row["domain"], row["family"]) for row in rows})
    rates = sorted({row["rate"] for row in rows})
    for number, (domain, family) in enumerate(families):
        for rate, line in zip(rates, ("-", "--", ":"), strict=False):
            parts: defaultdict[int, float] = defaultdict(float)
            wholes: defaultdict[int, float] = defaultdict(float)
            for row in rows:
                if (row["domain"], row["family"], row["rate"]) == (domain, family, rate):
                    parts[row["episodes"]] += row[part] * (row[whole] if part == "answered" else 1)
                    wholes[row["episodes"]] += row[whole]
            counts = sorted(parts)
            shares = [100 * parts[c] / max(1, wholes[c]) for c in counts]
            label = f"{domain} {family}, {rate:.0%} wrong"
            if counts:
                axes.plot(counts, shares, line, color=f"C{number}", marker="o", markersize=3, label=label)
    axes.set(xlabel="episodes", xlim=(-1, 51))
    axes.grid(alpha=0.3)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", type=Path)
    parser.add_argument("--out", type=Path, default=Path("distil.png"))
    arguments = parser.parse_args()
    rows = [json.loads(line) for line in arguments.rows.read_text().splitlines()]
    figure = Figure(figsize=(10, 4), layout="constrained")
    answered, asked = figure.subplots(1, 2)
    draw(answered, rows, "answered", "atoms")
    draw(asked, rows, "questions", "questions_of_teacher")
    answered.set(ylabel="atoms answered, %", ylim=(0, 102))
    asked.set(ylabel="questions, % of the teacher's alone", ylim=(-2, 102))
    answered.axhline(90, color="grey", linewidth=0.8)
    asked.axhline(10, color="grey", linewidth=0.8)
    figure.legend(*answered.get_legend_handles_labels(), loc="outside right upper", fontsize=7, frameon=False)
    figure.savefig(arguments.out, dpi=130, metadata={"Software": None})


if __name__ == "__main__":
    main()
