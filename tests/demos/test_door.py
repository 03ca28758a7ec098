"""Other rooms come in through the three doors of this one."""

from __future__ import annotations

import re
from pathlib import Path

import pix2pred

ROOT = Path(pix2pred.__file__).parent
DOORS = {"pix2pred.demos", "pix2pred.demos.authoring", "pix2pred.demos.importers"}


def test_nobody_outside_imports_past_a_door() -> None:
    outside = [p for p in ROOT.rglob("*.py") if p.relative_to(ROOT).parts[0] != "demos"]
    used = {m for p in outside for m in re.findall(r"(?:from|import) (pix2pred\.demos[\w.]*)", p.read_text())}
    assert used == DOORS
