"""``python -m pix2pred`` is the command line."""

from __future__ import annotations

import subprocess
import sys

from pix2pred import __version__


def test_the_package_runs_as_a_module() -> None:
    ran = subprocess.run([sys.executable, "-m", "pix2pred", "--version"], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == __version__
