"""The worked example of docs/initial_predicates.md: one initial predicate of every source, learned and solved with."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import yaml

from command_line import Cli
from pix2pred.structs.formats.world_model import load_model
from pix2pred.structs.predicates import source_name

DOC = Path(__file__).parents[2] / "docs" / "initial_predicates.md"


def test_every_source_in_one_domain(cli: Cli, project: Path, tmp_path: Path) -> None:
    match = re.search(r"```yaml\n(predicates:.*?)```", DOC.read_text(), re.DOTALL)
    assert match is not None
    predicates = yaml.load(match[1], Loader=yaml.BaseLoader)["predicates"]
    data, run = tmp_path / "data", tmp_path / "run"
    shutil.copytree(project, data)
    head, tail = (data / "domain.yaml").read_text().split("predicates:", 1)
    rest = tail[tail.index("\nlearning:") :]
    (data / "domain.yaml").write_text(head + match[1] + rest)
    assert cli("check", data).code == 0
    ran = cli("learn", data, "--out", run, "--json")
    assert ran.code == 0, ran.err
    model = load_model(run / "model" / "world_model.json")
    assert {source_name(p.source) for p in model.vocabulary.initial} == {p["source"] for p in predicates}
    assert len(predicates) == 5 == len({p["source"] for p in predicates})
    assert len(model.operators) == 7
    solved = cli("solve", run, "--tasks", data, "--json")
    assert solved.code == 0, json.dumps(solved.json["failures"])
    looking = cli("solve", run, "--tasks", data, "--closed-loop", "--json")
    assert looking.code == 0 and looking.json["solved"] == 2
    fresh = cli("solve", run, "--seed", 73, "--count", 1, "--json")
    assert fresh.code == 0, json.dumps(fresh.json["failures"])
