"""The bar chart of a comparison and the curves of a sweep. Needs the extra ``plot``."""

from __future__ import annotations

import io
from typing import Any

from pix2pred.benchmark.runner import Run
from pix2pred.benchmark.statistics import TableCell, cell_of
from pix2pred.system.errors import Pix2predError
from pix2pred.system.extras import install_command

COLOURS = ("#1b6ca8", "#9aa0a6", "#5f6368", "#c58b2a", "#7b9e3a", "#a4508b", "#d0694f", "#3aa6a0", "#7d6bb0")


class PlotError(Pix2predError, RuntimeError):
    """Charts cannot be drawn; the message names the extra to install."""


def check_charts() -> None:
    """Raises ``PlotError`` without matplotlib."""
    try:
        import matplotlib
    except ImportError as error:
        raise PlotError(f"charts need the extra 'plot': {install_command('plot')}") from error
    matplotlib.use("Agg")


def draw(run: Run) -> bytes:
    """The chart of a run as PNG. Raises ``PlotError`` without matplotlib."""
    check_charts()
    from matplotlib.figure import Figure

    families = [f for f in run.suite.groups()[0] if _any_cell(run, f.name)] or list(run.suite.families)
    names = [f.name for f in families]
    if run.suite.axis:
        figure = Figure(figsize=(4.2 * len(names), 3.4), layout="constrained")
        _curves(run, names, figure)
    else:
        figure = Figure(figsize=(max(6.0, 2.4 * len(names) + 2), 3.6), layout="constrained")
        _bars(run, names, figure.subplots())
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=130, metadata={"Software": None})
    return buffer.getvalue()


def _any_cell(run: Run, family: str) -> bool:
    return any(
        isinstance(cell_of(run.rows, a, family, v), TableCell) for a in run.suite.approaches for v in run.suite.values
    )


def _bars(run: Run, families: list[str], axes: Any) -> None:
    shown = [a for a in run.suite.approaches if any(isinstance(cell_of(run.rows, a, f), TableCell) for f in families)]
    width = 0.8 / max(1, len(shown))
    for i, approach in enumerate(shown):
        for x, family in enumerate(families):
            found = cell_of(run.rows, approach, family)
            if isinstance(found, TableCell):
                place = x + (i - (len(shown) - 1) / 2) * width
                colour = COLOURS[list(run.suite.approaches).index(approach) % len(COLOURS)]
                axes.bar(place, found.mean, width * 0.92, color=colour, label=approach if x == 0 else None)
                axes.errorbar(place, found.mean, found.sd, color="black", capsize=2, linewidth=0.8)
                axes.text(place, found.mean + found.sd + 0.15, f"{found.mean:.1f}", ha="center", fontsize=6.5)
    missing = [a for a in run.suite.approaches if a not in shown]
    axes.set_xticks(range(len(families)), families)
    axes.set_ylim(0, run.suite.tasks * 1.12)
    axes.set_ylabel(f"solved of {run.suite.tasks}")
    note = f"not scored: {', '.join(missing)}" if missing else ""
    axes.set_xlabel(f"mean and standard deviation over {len(run.suite.seeds)} seeds\n{note}".strip(), fontsize=8)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(fontsize=7, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))


def _curves(run: Run, families: list[str], figure: Any) -> None:
    assert run.suite.axis is not None, "the suite sweeps an axis"
    for axes, family in zip(figure.subplots(1, len(families), squeeze=False)[0], families, strict=True):
        for i, approach in enumerate(run.suite.approaches):
            points = [(v, cell_of(run.rows, approach, family, v)) for v in run.suite.values]
            found = [(v, c) for v, c in points if isinstance(c, TableCell) and v is not None]
            if found:
                xs, ys = [v for v, _ in found], [100 * c.mean / c.per_seed for _, c in found]
                sds = [100 * c.sd / c.per_seed for _, c in found]
                axes.errorbar(xs, ys, sds, marker="o", markersize=3, capsize=2, color=COLOURS[i], label=approach)
        axes.set_title(family, fontsize=9)
        axes.set_xlabel(run.suite.axis.of)
        axes.set_ylim(-5, 105)
        axes.set_ylabel("solved, %")
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(fontsize=7, frameon=False)
