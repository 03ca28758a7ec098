"""The world model as tools of other programs: over the real protocol, and as plain calls."""

from __future__ import annotations

import asyncio
import json
import shutil
import sys
from pathlib import Path
from typing import Any

import pytest

import newcomer
from cli.hostile_lamps import png
from extras import need
from lamps_run import learn_lamps
from pix2pred.api import Model, learn, load_solver
from pix2pred.cli.app import run as command
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.runs.photo_task import PhotoTaskError, known_objects
from pix2pred.serving import Tools
from pix2pred.vlm import VLMError

THINGS = ["robby:robot", "l1:lamp", "l2:lamp"]
GOAL = ["Done(l1)", "Done(l2)"]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    return learn_lamps(tmp_path_factory.mktemp("lamps"), "run")


def _tools(run: RunFolder, photos: Path, vlm: str) -> Tools:
    solver, _ = load_solver(run, "portfolio", vlm=vlm)
    return Tools(run, solver, photos)


@pytest.fixture
def tools(run: RunFolder, tmp_path: Path) -> Tools:
    return _tools(run, tmp_path, f"replay:{run.path}")


def test_the_model_is_told_with_the_meaning_of_its_words(tools: Tools) -> None:
    told = tools.world_model()
    assert told["skills"] == ["Press(robot, lamp)"]
    assert {p["predicate"] for p in told["predicates"]} >= {"Done(lamp)"}
    assert "(define (domain lamps)" in told["pddl"]
    json.dumps(told)


def test_a_plan_from_atoms_is_valid_and_explained(tools: Tools) -> None:
    planned = tools.plan_from_atoms(THINGS, [], GOAL)
    assert planned["status"] == "solved" and len(planned["lines"]) == 2
    checked = tools.validate(THINGS, [], GOAL, planned["lines"])
    assert checked["valid"] and {fact for step in checked["steps"] for fact in step["added"]} >= {"Done l1", "Done l2"}
    short = tools.validate(THINGS, [], GOAL, planned["lines"][:1])
    assert not short["valid"] and len(short["unmet"]) == 1


def test_goals_may_say_not_and_or(tools: Tools) -> None:
    goal = ["Done(l1) or Done(l2) and not Done(l1)"]
    planned = tools.plan_from_atoms(THINGS, [], goal)
    assert planned["status"] == "solved" and len(planned["lines"]) == 1
    assert tools.validate(THINGS, [], goal, planned["lines"])["valid"]
    assert not tools.validate(THINGS, [], goal, [])["valid"]
    assert tools.plan_from_atoms(THINGS, [], ["not Done(l1)"])["plan"] == []
    assert tools.plan_from_atoms(THINGS, ["Done(l1)"], ["not Done(l1)"])["status"] == "unsolvable"
    with pytest.raises(PhotoTaskError, match=r"at the end of 'Done\(l1\) or'"):
        tools.plan_from_atoms(THINGS, [], ["Done(l1) or"])


@pytest.fixture(scope="module")
def tea(tmp_path_factory: pytest.TempPathFactory) -> Model:
    """Five photos of tea, looked at by a person."""
    root = tmp_path_factory.mktemp("tea")
    newcomer.draw(root / "photos/tea")
    project = root / "project"
    assert command(["init", str(project), "--from-photos", str(root / "photos"), *newcomer.DECLARED]) == 0
    newcomer.fill_in(project / "demos/tea/demo.yaml")
    return learn(project, newcomer.Person())


def test_what_was_never_labelled_is_not_asked_unless_a_model_is_named(tea: Model, tmp_path: Path) -> None:
    newcomer.draw(tmp_path / "photos")
    run = RunFolder(tea.save(tmp_path / "run"))
    before = sorted(run.path.rglob("*"))
    with pytest.raises(VLMError, match="no answers to replay"):
        _tools(run, tmp_path / "photos", f"replay:{run.path}").describe(["0.jpg"])
    assert sorted(run.path.rglob("*")) == before


def test_photos_are_described_and_planned_for(tea: Model, tmp_path: Path) -> None:
    newcomer.draw(tmp_path / "photos")
    person = tea.solver.labeller.vlm
    assert isinstance(person, newcomer.Person)
    person.unseen = frozenset({"empty(hand)", "on(teabag, plate)", "on(two_pieces_of_ice, plate)"})
    tools = Tools(RunFolder(tea.save(tmp_path / "run")), tea.solver, tmp_path / "photos")
    photo = next(p.name for p in sorted((tmp_path / "photos").iterdir()))
    seen = tools.describe([photo])
    assert "In(ice, glass)" not in seen["holds"] and max(seen["believed"].values()) > 0.5
    planned = tools.plan_from_photos([photo], ["In(ice, glass)"])
    assert [step["action"].partition("(")[0] for step in planned["plan"]] == ["Pick", "PlaceIn"]
    things = [f"{o.name}:{o.type.name}" for o in known_objects(tools.run).values()]
    checked = tools.validate(things, seen["holds"], ["In(ice, glass)"], planned["lines"])
    assert checked["valid"]
    with pytest.raises(RunFolderError, match="at least one atom"):
        tools.plan_from_photos([photo], [])


@pytest.mark.parametrize("name", ["../new.png", "/etc/hostname", "missing.png", "", "."])
def test_only_pictures_in_the_folder_of_photos_are_opened(tools: Tools, name: str) -> None:
    (tools.photos.parent / "new.png").write_bytes(png(1))
    with pytest.raises(RunFolderError, match="no such photo"):
        tools.describe([name])


def test_a_link_out_of_the_folder_of_photos_is_not_followed(
    tools: Tools, tmp_path_factory: pytest.TempPathFactory
) -> None:
    outside = tmp_path_factory.mktemp("outside") / "new.png"
    outside.write_bytes(png(1))
    (tools.photos / "link.png").symlink_to(outside)
    with pytest.raises(RunFolderError, match="no such photo"):
        tools.describe(["link.png"])


@pytest.mark.parametrize(
    ("things", "holds", "goal", "complaint"),
    [
        (["l1:lantern"], [], ["Done(l1)"], "lantern"),
        (["l1"], [], ["Done(l1)"], "l1"),
        (["l1:lamp"], ["Dome(l1)"], ["Done(l1)"], "Dome"),
        (["l1:lamp"], [], ["Done(l9)"], "l9"),
        (["l1:lamp"], [], ["Done(l1"], "Done"),
    ],
)
def test_wrong_words_are_refused_by_name(
    tools: Tools, things: list[str], holds: list[str], goal: list[str], complaint: str
) -> None:
    with pytest.raises(RunFolderError, match=complaint):
        tools.plan_from_atoms(things, holds, goal)


def test_a_folder_of_photos_that_is_not_there(
    run: RunFolder, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert command(["mcp", str(run.path), "--photos", str(tmp_path / "nowhere")]) == 2
    assert "is no folder" in capsys.readouterr().err


class TestProtocol:
    """A client of the protocol's own SDK starts the program and calls it."""

    pytestmark = need("mcp", extra="mcp")

    @staticmethod
    def _called(run: RunFolder, photos: Path, *calls: tuple[str, dict[str, Any]]) -> tuple[list[Any], list[Any]]:
        from mcp import ClientSession, StdioServerParameters
        from mcp.client.stdio import stdio_client

        program = "from pix2pred.cli import main; main()"
        args = ["-c", program, "mcp", str(run.path), "--photos", str(photos)]

        async def talk() -> tuple[list[Any], list[Any]]:
            server = StdioServerParameters(command=sys.executable, args=args)
            async with stdio_client(server) as (read, write), ClientSession(read, write) as session:
                await session.initialize()
                listed = await session.list_tools()
                return listed.tools, [await session.call_tool(name, given) for name, given in calls]

        return asyncio.run(talk())

    def test_an_assistant_plans_and_checks(self, run: RunFolder, tmp_path: Path) -> None:
        shutil.copy(run.path.parent / "data/tasks/t0/images/0/main.png", tmp_path / "main.png")
        scene = {"objects": THINGS, "holds": [], "goal": GOAL}
        tools, (model, planned, refused) = self._called(
            run, tmp_path, ("world_model", {}), ("plan_from_atoms", scene), ("describe", {"photos": ["../x.png"]})
        )
        assert [t.name for t in tools] == [
            "world_model", "describe", "plan_from_photos", "plan_from_atoms", "validate"
        ]  # fmt: skip
        assert all(t.description and t.annotations.read_only_hint for t in tools)
        assert model.structured_content["name"] == "lamps"
        assert planned.structured_content["status"] == "solved" and not planned.is_error
        assert refused.is_error and "no such photo" in refused.content[0].text
