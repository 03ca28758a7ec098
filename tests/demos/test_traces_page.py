"""The page about traces: its example is valid by the schema, and is read."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import jsonschema
import pytest

from pix2pred.cli.app import run
from pix2pred.demos import json_schemas
from pix2pred.structs.formats.traces import load_traces

PAGE = Path(__file__).parents[2] / "docs" / "traces.md"


def test_the_example_is_what_the_page_says(tmp_path: Path) -> None:
    (text,) = re.findall(r"```json title=switches.json\n(.*?)```", PAGE.read_text(), re.DOTALL)
    jsonschema.validate(json.loads(text), json_schemas()["traces.schema.json"])
    (tmp_path / "switches.json").write_text(text)
    traces = load_traces(tmp_path / "switches.json")
    (demo,) = traces.table.demos
    assert [len(state) for state in demo.abstract_states()] == [0, 1, 3]
    assert [c.predicate.name for c in traces.table.pool] == ["Warm"]


def test_observations_of_other_learners_become_traces(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (code,) = re.findall(r"```python title=convert.py\n(.*?)```", PAGE.read_text(), re.DOTALL)
    (tmp_path / "convert.py").write_text(code)
    written = subprocess.run([sys.executable, tmp_path / "convert.py"], capture_output=True, text=True, check=True)
    (tmp_path / "traces.json").write_text(written.stdout)
    jsonschema.validate(json.loads(written.stdout), json_schemas()["traces.schema.json"])
    (demo,) = load_traces(tmp_path / "traces.json").table.demos
    assert [len(state) for state in demo.abstract_states()] == [0, 1, 2]
    assert run(["select", str(tmp_path / "traces.json"), "--out", str(tmp_path / "selection.json")]) == 0
    (operator,) = json.loads((tmp_path / "selection.json").read_text())["operators"]
    assert operator["add"] == [["lit", operator["parameters"][0][0]]], capfd.readouterr()
