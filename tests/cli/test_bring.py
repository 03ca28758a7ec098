"""Beginning a project and bringing data in: init, import, check, schema."""

from __future__ import annotations

import json
import re
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest

from cli.photos_of_tea import ACTIONS, GOAL, OPTIONS, fill_in, take_photos
from command_line import Cli
from demos.importers.made_data import sidecar, write_dataset, write_video
from demos.photo_files import SECRET, photo
from extras import need
from pix2pred.cli.init import interview
from pix2pred.demos import read_project


def problems(cli: Cli, project: Path) -> list[tuple[str, int, str]]:
    ran = cli("check", project, "--json", "--no-cost")
    assert ran.code == (2 if ran.json["problems"] else 0)
    return [(p["file"], p["line"], p["message"]) for p in ran.json["problems"]]


def test_the_example_is_sound_and_says_what_learning_costs(cli: Cli, tmp_path: Path) -> None:
    assert cli("init", tmp_path / "mine").code == 0
    ran = cli("check", tmp_path / "mine")
    assert ran.code == 0 and ran.out.startswith("no problems found\nlearning with openai:gpt-4o would ask about 18 ")
    ran = cli("check", tmp_path / "mine", "--vlm", "mailbox:inbox", "--json")
    assert ran.json["learning"]["queries"] == 18 and ran.json["warnings"] == []
    assert not (tmp_path / "inbox").exists() and not Path("no-answers").exists()


def test_nothing_is_replaced_without_being_told(cli: Cli, tmp_path: Path) -> None:
    assert cli("init", tmp_path).code == 0
    (tmp_path / "notes.txt").write_text("mine")
    before = (tmp_path / "domain.yaml").read_text()
    ran = cli("init", tmp_path, "--type", "cup")
    assert ran.code == 2 and "domain.yaml: exists already" in ran.err and "--overwrite" in ran.err
    assert (tmp_path / "domain.yaml").read_text() == before
    assert cli("init", tmp_path, "--type", "cup", "--overwrite").code == 0
    assert "two-cups" not in {p.name for p in (tmp_path / "demos").iterdir()}
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_from_photos_to_a_project_that_can_be_learned_from(cli: Cli, tmp_path: Path) -> None:
    take_photos(tmp_path / "photos")
    project = tmp_path / "tea"
    assert cli("init", project, "--from-photos", tmp_path / "photos", *OPTIONS).code == 0
    found = problems(cli, project)
    for file, line, message in found:
        assert Path(file).read_text().splitlines()[line - 1].startswith("- TODO")
        assert message.startswith("to be filled in: ")
    assert len(found) == 2 * (1 + len(ACTIONS))
    assert "Pick(robot, cup), Pour(robot, pot, cup)" in found[1][2]
    assert not any(SECRET.encode() in path.read_bytes() for path in project.rglob("*") if path.is_file())
    for demo in ("monday", "tuesday"):
        fill_in(project / "demos" / demo / "demo.yaml")
    assert problems(cli, project) == []
    read = read_project(project)
    assert [str(a) for a in read.demos[0].actions] == list(ACTIONS) and str(read.demos[0].goal[0]) == GOAL
    assert [s.pictures[0].image.size for s in read.demos[1].states] == [(120, 160)] * 3


def test_photos_alone_leave_the_domain_to_fill_in(cli: Cli, tmp_path: Path) -> None:
    take_photos(tmp_path / "photos")
    assert cli("init", tmp_path / "tea", "--from-photos", tmp_path / "photos" / "monday").code == 0
    messages = "\n".join(m for _, _, m in problems(cli, tmp_path / "tea"))
    for what in ("the kinds of objects", "what can be done", "what goals are written in", "the objects of this scene"):
        assert what in messages


def test_bad_photos_leave_nothing_behind(cli: Cli, tmp_path: Path) -> None:
    take_photos(tmp_path / "photos")
    (tmp_path / "photos/monday/2.jpg").write_bytes(b"junk")
    ran = cli("init", tmp_path / "tea", "--from-photos", tmp_path / "photos")
    assert ran.code == 2 and "2.jpg" in ran.err and "Traceback" not in ran.err
    assert [p.name for p in tmp_path.iterdir()] == ["photos"]
    ran = cli("init", tmp_path / "photos" / "tea", "--from-photos", tmp_path / "photos")
    assert ran.code == 2 and "lies among the photos" in ran.err


def test_terminated_among_the_photos_nothing_is_left_behind(tmp_path: Path) -> None:
    first = photo(tmp_path / "photos/0.png", size=(1600, 1200))
    for i in range(1, 400):
        (tmp_path / f"photos/{i}.png").hardlink_to(first)
    program = "from pix2pred.cli import main; main()"
    command: list[str | Path] = [
        sys.executable, "-c", program, "init", tmp_path / "tea", "--from-photos", tmp_path / "photos"
    ]  # fmt: skip
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and not list(tmp_path.glob(".pix2pred-*/new/demos/*/images/1")):
        time.sleep(0.02)
    process.send_signal(signal.SIGTERM)
    assert process.wait(120) == 128 + signal.SIGTERM
    assert [p.name for p in tmp_path.iterdir()] == ["photos"]


def test_what_is_declared_wrongly_is_said_at_once(cli: Cli, tmp_path: Path) -> None:
    ran = cli("init", tmp_path / "x", "--type", "cup", "--skill", "Pick(cap)", "--predicate", "On(cup) = domain")
    assert ran.code == 2 and "source 'domain' is for simulators" in ran.err
    ran = cli("init", tmp_path / "x", "--type", "cup", "--skill", "Pick(cap)")
    assert ran.code == 2 and "did you mean 'cup'?" in ran.err and not (tmp_path / "x").exists()


def test_the_interview_asks_again_for_what_it_cannot_understand() -> None:
    answers: Iterator[str] = iter(
        [
            "cup",
            "my cup",
            "robot",
            "",
            "mug:cpu",
            "mug:cup = my mug",
            "",
            "Pick(robot, cup)",
            "",
            "On(cup)",
            "On(cup) = vlm",
        ]
    )
    told: list[str] = []

    def ask(prompt: str) -> str:
        try:
            return next(answers)
        except StopIteration:
            raise EOFError from None

    given = interview(ask, told.append)
    assert given == [["cup", "robot"], ["mug:cup = my mug"], ["Pick(robot, cup)"], ["On(cup) = vlm"]]
    assert sum(line.startswith("  ") for line in told) == 3
    assert interview(lambda prompt: "", told.append) == [[], [], [], []]


def test_frames_are_added_to_a_project(cli: Cli, tmp_path: Path) -> None:
    take_photos(tmp_path / "photos")
    cli("init", tmp_path / "tea", *OPTIONS)
    (tmp_path / "steps.txt").write_text("\n".join(ACTIONS))
    options = (
        "import",
        "frames",
        tmp_path / "photos/monday",
        "--actions",
        tmp_path / "steps.txt",
        "--out",
        tmp_path / "tea",
    )
    ran = cli(*options)
    assert ran.code == 0 and "steps: 3 states" in ran.out and "Not known from photos" in ran.out
    assert "pix2pred check" in ran.err
    files = {Path(file).parent.name for file, _, _ in problems(cli, tmp_path / "tea")}
    assert files == {"example", "steps"}
    ran = cli(*options)
    assert ran.code == 2 and "exists already" in ran.err
    assert cli(*options, "--overwrite").code == 0


@pytest.mark.parametrize("actions", ["Pick(robott, mug)", "Pik(robot, mug)"])
def test_a_misspelt_action_is_found_by_check(cli: Cli, tmp_path: Path, actions: str) -> None:
    take_photos(tmp_path / "photos")
    cli("init", tmp_path / "tea", *OPTIONS)
    (tmp_path / "a.txt").write_text(f"{actions}\n{ACTIONS[1]}")
    cli("import", "frames", tmp_path / "photos/monday", "--actions", tmp_path / "a.txt", "--out", tmp_path / "tea")
    assert any("did you mean" in message for _, _, message in problems(cli, tmp_path / "tea"))


@need("av", extra="video")
def test_a_video_becomes_a_project(cli: Cli, tmp_path: Path) -> None:
    video = write_video(tmp_path / "my tea.mp4", 30, size=(128, 112))
    (tmp_path / "tea.csv").write_text('seconds,action\n0,\n1.0,"Pick(robot, mug)"\n0:02.5,"Pour(robot, pot, mug)"\n')
    ran = cli("import", "video", video, "--actions", tmp_path / "tea.csv", "--out", tmp_path / "p", "--json")
    assert ran.code == 0 and ran.json["demonstrations"] == {"tea": 3} and ran.json["problems"] > 0
    assert "Not known from a video" in ran.json["notes"]["tea"][1]
    cli("init", tmp_path / "q", *OPTIONS)
    cli("import", "video", video, "--actions", tmp_path / "tea.csv", "--out", tmp_path / "q")
    assert [m[:15] for f, _, m in problems(cli, tmp_path / "q") if "tea" in f] == ["to be filled in"], "the goal"


@need("pyarrow", "av", extra="lerobot")
def test_a_lerobot_dataset_becomes_a_project(cli: Cli, tmp_path: Path) -> None:
    source = write_dataset(tmp_path / "data")
    steps = [{"do": "Pick(robot, mug)", "until": 1}]
    file = sidecar(tmp_path / "s.yaml", {"name": "one", "from": 0, "steps": steps, "goal": ["Full(mug)"]})
    cli("init", tmp_path / "p", *OPTIONS)
    assert cli("import", "lerobot", source, "--sidecar", file, "--out", tmp_path / "p").code == 0
    assert not any("one" in file for file, _, _ in problems(cli, tmp_path / "p"))


def test_settings_that_learning_would_refuse_are_a_problem(cli: Cli, tmp_path: Path) -> None:
    cli("init", tmp_path)
    with (tmp_path / "domain.yaml").open("a") as file:
        file.write("learning: {foo: 3}\n")
    assert [m for _, _, m in problems(cli, tmp_path) if "foo" in m]


def test_schemas_are_printed_or_written(cli: Cli, tmp_path: Path) -> None:
    assert set(cli("schema").json) == {f"{kind}.schema.json" for kind in ("domain", "demo", "task", "import", "traces")}
    assert cli("schema", "--out", tmp_path).code == 0
    assert json.loads((tmp_path / "demo.schema.json").read_text())["title"] == "pix2pred demo.yaml"


def test_the_page_shows_commands_that_work(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every command of docs/importing.md whose data this test can make, in the order of the page."""
    page = (Path(__file__).parents[2] / "docs" / "importing.md").read_text()
    monkeypatch.chdir(tmp_path)
    take_photos(Path("photos"))
    for block in re.findall(r"```(\w+) title=(\S+)\n(.*?)```", page, re.DOTALL):
        Path(block[1]).write_text(block[2])
    if find_spec("av"):
        write_video(Path("tea.mp4"), 230)
    if find_spec("av") and find_spec("pyarrow"):
        write_dataset(Path("datasets/pick-cubes"), (60, 80))
    ran = 0
    for command in re.findall(r"^pix2pred ((?:.*\\\n)*.*)$", page, re.MULTILINE):
        words = shlex.split(command.replace("\\\n", " "), comments=True)
        needs = {"video": ["av"], "lerobot": ["av", "pyarrow"]}.get(words[1], []) if words[0] == "import" else []
        if all(find_spec(name) for name in needs):
            result = cli(*words)
            assert result.code == (2 if words[0] == "check" else 0), (words, result.err, result.out)
            ran += 1
    assert ran >= 5
