"""``export hub-folder``: what others get is complete, reads again, and gives nothing away."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from command_line import Cli
from demos.photo_files import SECRET, photo
from lamps_run import learn_lamps
from pix2pred.demos import project_digest, read_project
from pix2pred.planning.pddl.read import read_domain
from pix2pred.structs.formats.world_model import load_model


def _front(card: str) -> dict[str, object]:
    fields = yaml.safe_load(card.split("---\n")[1])
    assert isinstance(fields, dict)
    return fields


@pytest.fixture
def data(tmp_path: Path) -> Path:
    """The project of a run, one of whose pictures says where it was taken."""
    run = learn_lamps(tmp_path, "run")
    folder = run.path.parent / "data"
    picture = folder / "demos/d0/images/0"
    (picture / "main.png").unlink()
    photo(picture / "main.jpg", seed=1, time="2026:05:01 10:00:00")
    return folder


def test_a_project_is_shared_whole_and_without_secrets(cli: Cli, data: Path, tmp_path: Path) -> None:
    assert any(SECRET.encode() in p.read_bytes() for p in data.rglob("*.jpg"))
    hub = tmp_path / "hub"
    ran = cli("export", "hub-folder", data, "--licence", "cc-by-4.0", "--title", "Lamps: on", "--out", hub, "--json")
    assert ran.code == 0, ran.err
    assert not any(SECRET.encode() in p.read_bytes() for p in hub.rglob("*") if p.is_file())
    again = read_project(hub)
    assert [d.name for d in again.demos] == ["d0", "d1"]
    kept = data / "demos/d1/images/0/main.png"
    assert (hub / "demos/d1/images/0/main.png").read_bytes() == kept.read_bytes()
    assert project_digest(again) != "" and "README.md" in ran.json["files"]
    front = _front((hub / "README.md").read_text())
    assert front["license"] == "cc-by-4.0" and front["pretty_name"] == "Lamps: on"
    assert "`Press(robot, lamp)`" in (hub / "README.md").read_text()
    assert cli("check", hub).code == cli("check", data).code


def test_a_model_is_shared_without_pictures_answers_and_paths(cli: Cli, data: Path, tmp_path: Path) -> None:
    run, hub = data.parent / "run", tmp_path / "hub"
    assert cli("export", "hub-folder", run, "--licence", "mit", "--out", hub).code == 0
    assert sorted(p.relative_to(hub).as_posix() for p in hub.rglob("*") if p.is_file()) == [
        "README.md", "metrics.json", "model/domain.pddl", "model/world_model.json"
    ]  # fmt: skip
    assert load_model(hub / "model/world_model.json") == load_model(run / "model/world_model.json")
    assert not any(str(tmp_path).encode() in p.read_bytes() for p in hub.rglob("*") if p.is_file())
    card = (hub / "README.md").read_text()
    assert _front(card)["library_name"] == "pix2pred"
    assert read_domain(card.split("```lisp\n")[1].split("```")[0]).name == "lamps"


@pytest.mark.parametrize(
    ("licence", "source", "out", "complaint"),
    [
        ("my own", "data", "hub", "licence"),
        ("mit", "nowhere", "hub", "neither a project"),
        ("mit", "data", "data", "there already"),
    ],
)
def test_what_cannot_be_shared_is_refused(
    cli: Cli, data: Path, licence: str, source: str, out: str, complaint: str
) -> None:
    root = data.parent
    ran = cli("export", "hub-folder", root / source, "--licence", licence, "--out", root / out)
    assert ran.code == 2 and complaint in ran.err and "Traceback" not in ran.err
