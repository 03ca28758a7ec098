"""Suites as data, a resumable runner, and what its rows say: tables, charts, published claims."""

from pix2pred.benchmark.rows import Row, TryOutcome, read_rows
from pix2pred.benchmark.runner import Run, run_suite, status_of
from pix2pred.benchmark.suite import Suite, SuiteError, load_suite

__all__ = ["Row", "Run", "Suite", "SuiteError", "TryOutcome", "load_suite", "read_rows", "run_suite", "status_of"]
