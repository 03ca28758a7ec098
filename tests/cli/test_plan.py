"""``pix2pred plan`` from the command line: files, outcomes, a person executing, sessions that are killed and go on."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest
from markupsafe import escape
from PIL.ExifTags import Base

import cli.hostile_lamps as lamps
from command_line import Cli
from lamps_run import BOMB, learn_lamps
from pix2pred.cli.guide import TypedPaths
from pix2pred.planning import is_valid
from pix2pred.planning.pddl.read import read_domain, read_problem
from pix2pred.registry import Registry
from pix2pred.report.plan_page import POLICY
from pix2pred.structs import Atom, FromVLM, GroundOperator, Image, Object, Predicate, Type
from pix2pred.vlm import Request

Person = Callable[..., None]


@pytest.fixture(scope="module")
def learned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("lamps")
    learn_lamps(root, "run")
    return root


@pytest.fixture
def run(cli: Cli, learned: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of a learned run beside its data; the model sees what is in the pictures, and says so with markup."""
    import shutil

    shutil.copytree(learned, tmp_path / "lamps")
    cli.registry = registry(says)
    monkeypatch.chdir(tmp_path)
    return tmp_path / "lamps" / "run"


def says(request: Request) -> str:
    return lamps.sees(request).replace("As seen.", f"As seen {BOMB}")


def registry(label: lamps.Say) -> Registry:
    return lamps.OneModel(lamps.Fake(label, label, f"fake{BOMB}"))


@pytest.fixture
def types(monkeypatch: pytest.MonkeyPatch) -> Person:
    """What the person types, line by line; then the input ends."""

    def typed(*lines: object) -> None:
        monkeypatch.setattr(sys, "stdin", io.StringIO("".join(f"{line}\n" for line in lines)))

    return typed


def task(run: Path) -> Path:
    return run.parent / "data/tasks/t0"


def photo(name: str, lit: int, shade: int = 60) -> Path:
    path = Path(name)
    path.write_bytes(lamps.png(lit, shade=shade))
    boxes = "pictures: {main: {l1: [0, 0, 20, 20], l2: [20, 0, 40, 20], robby: [0, 20, 40, 30]}}\n"
    path.with_suffix(".yaml").write_text(boxes + "features: {l1: [0], l2: [0]}\n")
    return path


def plan_json(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "plan.json").read_text())
    return found


def test_a_plan_is_written_as_pddl_and_explained(cli: Cli, run: Path) -> None:
    ran = cli("plan", run, "--task", task(run))
    assert ran.code == 0, ran.err
    folder = run / "plans/t0"
    assert [line.split() for line in ran.out.splitlines()[1:3]] == [
        ["1", "Press:", "robby,", "l1"], ["2", "Press:", "robby,", "l2"],
    ]  # fmt: skip
    domain = read_domain((folder / "domain.pddl").read_text())
    problem = read_problem((folder / "problem.pddl").read_text(), domain)
    by_name = {op.name.lower(): op for op in domain.operators}
    objects = {o.name: o for o in problem.objects}
    steps: list[GroundOperator] = []
    for line in (folder / "plan.txt").read_text().splitlines():
        name, *args = line.strip("()").split()
        steps.append(by_name[name].ground(tuple(objects[a] for a in args)))
    assert len(steps) == 2 and is_valid(steps, problem.initial, problem.goal)
    document = plan_json(folder)
    assert document["status"] == "solved" and [s["action"] for s in document["plan"]] == [
        "Press(robby, l1)", "Press(robby, l2)",
    ]  # fmt: skip
    page = (folder / "plan.html").read_text()
    assert escape(POLICY) in page and "<script" not in page and "data:image/webp" in page
    again = {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()}
    assert cli("plan", run, "--task", task(run)).code == 0
    assert {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()} == again


def test_what_others_wrote_is_escaped_everywhere(cli: Cli, run: Path) -> None:
    sheet = task(run) / "task.yaml"
    descriptor = f'"{BOMB.replace(chr(34), "")}"'
    sheet.write_text(sheet.read_text().replace("l1: {type: lamp}", f"l1: {{type: lamp, descriptor: {descriptor}}}"))
    ran = cli("plan", run, "--task", task(run), "--out", "x<script>y")
    assert ran.code == 0, ran.err
    page = Path("x<script>y/plan.html").read_text()
    assert "window.boom" in page and "<script" not in page and "<img src=x" not in page


def test_without_a_plan_the_exit_code_is_1_and_what_is_missing_is_said(cli: Cli, run: Path, types: Person) -> None:
    sheet = task(run) / "task.yaml"
    sheet.write_text(sheet.read_text().replace("robby: {type: robot}", "robby: {type: plug}"))
    ran = cli("plan", run, "--task", task(run), "--interactive", "--json")
    assert ran.code == 1 and ran.json["status"] == "unsolvable"
    assert [m["atom"] for m in ran.json["missing"]] == ["Done(l1)", "Done(l2)"]
    assert not (run / "plans/t0/plan.txt").exists()
    assert "What is missing" in (run / "plans/t0/plan.html").read_text()


def test_a_person_executes_with_a_failed_step(cli: Cli, run: Path, types: Person) -> None:
    types(photo("a.png", 0), "y", "n", "typo.png", photo("b.png", 1), "", photo("c.png", 2), "")
    ran = cli("plan", run, "--task", task(run), "--interactive")
    assert ran.code == 0, ran.err
    assert "expected, not seen: +Done(l1)" in ran.out and "planned again: 2 skills" in ran.out
    assert "typo.png: does not exist" in ran.err
    assert "the goal holds in the last photo" in ran.out
    document = plan_json(run / "plans/t0")
    assert [e["action"] for e in document["executed"]] == ["Press(robby, l1)"] * 2 + ["Press(robby, l2)"]
    assert document["goal_holds"] and document["executed"][0]["planned_again"]


@pytest.mark.parametrize(("line", "tried"), [("y", True), ("", False), (None, False)])
def test_a_person_is_asked_before_a_plan_is_tried_that_rests_on_what_is_not_seen(
    capsys: pytest.CaptureFixture[str], types: Person, line: str | None, tried: bool
) -> None:
    types(*[] if line is None else [line])
    atom = Atom(Predicate("lit0", (Type("lamp"),), FromVLM("lit")), (Object("l1", Type("lamp")),))
    assert TypedPaths().may_assume([atom]) is tried
    assert "there is one if these hold all the same: lit0(l1)" in " ".join(capsys.readouterr().out.split())


def test_the_same_command_goes_on_where_the_input_ended(cli: Cli, run: Path, types: Person) -> None:
    command = ("plan", run, "--task", task(run), "--interactive")
    types(photo("a.png", 1), "")
    stopped = cli(*command)
    assert stopped.code == 1 and "the same command goes on" in stopped.out
    session = json.loads((run / "plans/t0/session.json").read_text())
    assert [e["photo"] for e in session["executed"]] == ["a.png"]
    page = (run / "plans/t0/plan.html").read_bytes()
    assert cli("plan", run, "--task", task(run)).code == 0  # looks again, and forgets nothing
    assert (run / "plans/t0/plan.html").read_bytes() == page and b"Executed so far" in page
    types(photo("b.png", 2), "")
    ran = cli(*command)
    assert ran.code == 0 and "step 1, done before" in ran.out
    types()
    assert cli(*command).code == 0  # nothing is left to do
    retaken = cli(*command, "--retake")
    assert retaken.code == 1 and len(plan_json(run / "plans/t0")["executed"]) == 1


def test_photos_of_a_session_keep_neither_place_nor_owner(cli: Cli, run: Path, types: Person) -> None:
    path = photo("a.png", 1)
    exif = PIL.Image.Exif()
    exif[Base.Artist] = "Ada Lovelace"
    with PIL.Image.open(path) as opened:
        opened.save(path, exif=exif)
    types(path, "")
    cli("plan", run, "--task", task(run), "--interactive")
    assert b"Lovelace" in path.read_bytes()
    kept = run / "plans/t0/images/1/main.png"
    assert b"eXIf" not in kept.read_bytes() and np.array_equal(Image(kept).pixels(), Image(path).pixels())


def test_a_session_of_another_task_is_refused(cli: Cli, run: Path, types: Person) -> None:
    types(photo("a.png", 1), "")
    cli("plan", run, "--task", task(run), "--interactive")
    (task(run) / "images/0/main.png").write_bytes(lamps.png(1))
    ran = cli("plan", run, "--task", task(run), "--interactive")
    assert ran.code == 2 and "another task or world model" in ran.err
    Path("other").mkdir()
    Path("other/thesis.txt").write_text("mine")
    ran = cli("plan", run, "--task", task(run), "--out", "other")
    assert ran.code == 2 and "holds other files" in ran.err and len(list(Path("other").iterdir())) == 1


def test_photos_are_taken_from_a_folder_as_they_appear(cli: Cli, run: Path) -> None:
    Path("inbox").mkdir()
    photo("inbox/1.png", 1)
    photo("inbox/2.png", 2)
    os.utime("inbox/1.png", (1, 1))
    ran = cli("plan", run, "--task", task(run), "--photos", "inbox", "--json")
    assert ran.code == 0, ran.err
    assert [e["assumed"] for e in ran.json["executed"]] == [["+Done(l1)"], ["+Done(l2)"]]
    assert cli("plan", run, "--task", task(run), "--photos", "nowhere", "--out", "new").code == 2


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (b"no picture", "neither PNG nor JPEG"),
        (lamps.png()[:60], "cannot be read as a picture"),
        (b"", "neither PNG nor JPEG"),
    ],
)
def test_a_bad_photo_is_asked_for_again(cli: Cli, run: Path, types: Person, content: bytes, complaint: str) -> None:
    Path("bad.png").write_bytes(content)
    types("bad.png")
    ran = cli("plan", run, "--task", task(run), "--interactive")
    assert complaint in " ".join(ran.err.split()) and "stopped" in ran.out
    assert not (run / "plans/t0/session.json").exists()


def test_a_bad_file_beside_a_photo_is_said_by_line(cli: Cli, run: Path, types: Person) -> None:
    path = photo("a.png", 1)
    path.with_suffix(".yaml").write_text('given: ["Dome(l1)"]\npictures:\n  side: {}\n')
    types(path)
    ran = cli("plan", run, "--task", task(run), "--interactive")
    assert "a.yaml:1: predicate 'Dome' is not declared; did you mean 'Done'" in ran.err
    assert "a.yaml:3: there is no camera 'side'; the task has main" in ran.err


def test_a_killed_session_loses_no_photo(run: Path) -> None:
    """Killed while the model is thinking about the first photo; the photo itself is kept."""
    Path("inbox").mkdir()
    photo("inbox/1.png", 1)
    program = Path(lamps.__file__)
    arguments = ["plan", str(run), "--task", str(task(run)), "--photos", "inbox"]
    slow = (
        "import sys, time; import cli.hostile_lamps as lamps\n"
        "def say(r):\n"
        "    if len(r.views) > 1: time.sleep(60)\n"
        "    return lamps.sees(r)\n"
        "from pix2pred.cli import main\n"
        f"main({arguments!r}, lamps.OneModel(lamps.Fake(say, say, {'fake' + BOMB!r})))\n"
    )
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(program.parents[1]), *sys.path])}
    process = subprocess.Popen([sys.executable, "-c", slow], env=environment, stderr=subprocess.DEVNULL)
    session = run / "plans/t0/session.json"
    for _ in range(2400):
        if session.exists():
            break
        time.sleep(0.05)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert [e["photo"] for e in json.loads(session.read_text())["executed"]] == ["1.png"]
    photo("inbox/2.png", 2)
    done = subprocess.run(  # hangs if the first photo was lost
        [sys.executable, "-c", slow.replace("time.sleep(60)", "pass")],
        env=environment, capture_output=True, text=True, check=False, timeout=60,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "step 1, done before" in done.stdout and "the goal holds" in done.stdout
