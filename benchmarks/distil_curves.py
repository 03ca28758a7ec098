"""A picture of what ``distil.py`` measured: shares answered and right, and questions, over the number of episodes.

python benchmarks/distil_curves.py runs/distil/rows.jsonl --out distil.png
"""

from __future__ import annotations

import argparse
import json
from collections import defaultdict
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

Row = dict[str, Any]
Share = Callable[[Row], tuple[float, float]]
"""Of a row a part and the whole that it is a part of; both are summed over seeds."""


def answered(row: Row) -> tuple[float, float]:
    return row["answered"] * row["atoms"], row["atoms"]


def right(row: Row) -> tuple[float, float]:
    return row["right"] * row["answered"] * row["atoms"], row["answered"] * row["atoms"]


def asked(row: Row) -> tuple[float, float]:
    return row["questions"], row["questions_of_teacher"]


def draw(axes: Axes, rows: Sequence[Row], share: Share) -> None:
    """A line for every family and share of wrong labels of which there is more than one number of episodes."""
    families = sorted({(row["domain"], row["family"]) for row in rows})
    rates = sorted({row["rate"] for row in rows}, reverse=True)
    for number, (domain, family) in enumerate(families):
        for rate, line in zip(rates, ("-", "--", ":"), strict=False):
            sums: defaultdict[int, tuple[float, float]] = defaultdict(lambda: (0.0, 0.0))
            for row in rows:
                if (row["domain"], row["family"], row["rate"]) == (domain, family, rate):
                    part, whole = share(row)
                    sums[row["episodes"]] = sums[row["episodes"]][0] + part, sums[row["episodes"]][1] + whole
            if len(sums) > 1:
                counts = sorted(sums)
                shares = [100 * sums[c][0] / max(1, sums[c][1]) for c in counts]
                label = f"{domain} {family}, {rate:.0%} wrong"
                axes.plot(counts, shares, line, color=f"C{number}", marker="o", markersize=3, label=label)
    axes.set(xlabel="episodes", xlim=(-1, 51))
    axes.grid(alpha=0.3)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", type=Path)
    parser.add_argument("--out", type=Path, default=Path("distil.png"))
    arguments = parser.parse_args()
    rows = [json.loads(line) for line in arguments.rows.read_text().splitlines()]
    figure = Figure(figsize=(12, 4), layout="constrained")
    panels = figure.subplots(1, 3)
    bars = (
        ("atoms answered, %", answered, 90),
        ("of these right, %", right, 98),
        ("questions, % of the teacher's", asked, 10),
    )
    for axes, (label, share, bar) in zip(panels, bars, strict=True):
        draw(axes, rows, share)
        axes.axhline(bar, color="grey", linewidth=0.8)
        axes.set_ylabel(label)
    panels[0].set_ylim(top=101)
    panels[1].set_ylim(90, 100.3)
    panels[2].set_ylim(bottom=-1)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper", fontsize=7, frameon=False)
    figure.savefig(arguments.out, dpi=130, metadata={"Software": None})


if __name__ == "__main__":
    main()
