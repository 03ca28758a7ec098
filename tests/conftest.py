"""Tests of optional extras: skipped where the extra is not installed, unless skipping is not allowed."""

from __future__ import annotations

import os
from importlib.util import find_spec

import pytest


def need(module: str, *, extra: str) -> None:
    """Skip the calling test or module without ``module``. ``PIX2PRED_NO_SKIPS=1`` makes that a failure."""
    if find_spec(module) is None:
        skip_or_fail(f"{module} is not installed; install it with: pip install 'pix2pred[{extra}]'")


def skip_or_fail(reason: str) -> None:
    """Skip the calling test or module, or fail it where skips are not allowed."""
    if os.environ.get("PIX2PRED_NO_SKIPS") == "1":
        pytest.fail(reason, pytrace=False)
    pytest.skip(reason, allow_module_level=True)
