"""The page about traces: its example is valid by the schema, and is read."""

from __future__ import annotations

import json
import re
from pathlib import Path

import jsonschema

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
