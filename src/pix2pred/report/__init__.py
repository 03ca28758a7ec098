"""The report of a run: a pure function of the run folder, one HTML file that needs no network."""

from __future__ import annotations

from pathlib import Path

from pix2pred.report.contents import load_contents
from pix2pred.report.page import render
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.layout import REPORT

__all__ = ["REPORT", "load_contents", "render", "write_report"]


def write_report(run: RunFolder) -> Path:
    """Write the report of a finished run anew; gives its path."""
    return run.write(REPORT, render(load_contents(run)))
