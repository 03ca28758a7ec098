"""The published schemas are those of the models, and accept what the program writes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from demos import test_check
from pix2pred.demos import json_schemas, write_schemas
from pix2pred.demos.authoring.domain_text import domain_text
from pix2pred.demos.authoring.drafts import write_drafts
from pix2pred.demos.authoring.example import example_declarations, example_drafts
from pix2pred.demos.files.yaml_lines import parse_yaml

PUBLISHED = Path(__file__).parents[2] / "docs" / "schemas"


def errors(kind: str, text: str) -> list[str]:
    schema = json_schemas()[f"{kind}.schema.json"]
    jsonschema.Draft202012Validator.check_schema(schema)
    data: Any = parse_yaml(text.encode()).data
    return [e.message for e in jsonschema.Draft202012Validator(schema).iter_errors(data)]


def test_the_published_schemas_are_those_of_the_models() -> None:
    published = {path.name: json.loads(path.read_text()) for path in PUBLISHED.iterdir()}
    assert published == json_schemas(), "run: pix2pred schema --out docs/schemas"


def test_what_init_writes_names_its_schema_and_satisfies_it(tmp_path: Path) -> None:
    write_drafts(tmp_path, example_drafts(), domain_text("example", example_declarations()))
    files = sorted(tmp_path.rglob("*.yaml"))
    assert len(files) == 3
    for file in files:
        text = file.read_text()
        mark, _, place = text.splitlines()[0].partition("$schema=")
        assert mark == "# yaml-language-server: "
        schema = file.parent / place
        assert json.loads(schema.read_text()) == json_schemas()[schema.name]
        assert errors(schema.name.partition(".")[0], text) == []


@pytest.mark.parametrize(("kind", "text"), [("domain", "DOMAIN"), ("demo", "DEMO"), ("task", "TASK")])
def test_files_made_by_hand_satisfy_their_schema(kind: str, text: str) -> None:
    assert errors(kind, getattr(test_check, text)) == []


def test_a_camera_without_boxes_may_be_left_empty() -> None:
    assert errors("demo", test_check.DEMO.replace("{main: {}}", "{main: }")) == []


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("domain", test_check.DOMAIN.replace("descriptor: red", "colour: red")),
        ("domain", test_check.DOMAIN.replace("source: human", "source: people")),
        ("domain", test_check.DOMAIN.replace("version: 1", "version: 2")),
        ("demo", test_check.DEMO.replace("goal:", "gaol:")),
        ("demo", test_check.DEMO.replace("[0, 0, 4, 4]", "[0, 0, 4]")),
        ("task", test_check.TASK.replace("type: cup}", "kind: cup}")),
        ("import", "format: pix2pred-import\nversion: 1\ndemos: []\n"),
    ],
)
def test_what_is_wrong_is_found_by_the_schema_too(kind: str, text: str) -> None:
    assert errors(kind, text)


def test_schemas_are_written_as_files(tmp_path: Path) -> None:
    assert {p.name for p in write_schemas(tmp_path / "new")} == {
        "domain.schema.json", "demo.schema.json", "task.schema.json", "import.schema.json", "traces.schema.json",
    }  # fmt: skip
