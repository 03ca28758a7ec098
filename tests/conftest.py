"""Tests of optional extras: skipped where the extra is not installed, failed where nothing may be skipped."""

from __future__ import annotations

import os
import signal
from importlib.util import find_spec

import hypothesis
import pytest

hypothesis.settings.register_profile("behaviour, never time", deadline=None, derandomize=True)
hypothesis.settings.load_profile("behaviour, never time")


def pytest_configure(config: pytest.Config) -> None:
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # so shells start what runs in the background
        signal.signal(signal.SIGINT, signal.default_int_handler)  # programs that tests start and interrupt inherit it
    config.addinivalue_line("markers", "extra(*modules, extra): needs optional packages; see tests/extras.py")


def _found(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:  # the package that should hold it
        return False


def pytest_runtest_setup(item: pytest.Item) -> None:
    for mark in item.iter_markers("extra"):
        missing = [module for module in mark.args if not _found(module)]
        if missing:
            reason = f"needs {', '.join(missing)}: pip install 'pix2pred[{mark.kwargs['extra']}]'"
            if os.environ.get("PIX2PRED_NO_SKIPS") == "1":
                pytest.fail(reason, pytrace=False)
            pytest.skip(reason)
