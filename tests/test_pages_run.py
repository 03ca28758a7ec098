"""Commands that README and docs print are run as printed, in order, in one folder; each other one has a reason.

What the pages call by name is there before: photos, a project and a run of tea, and copies of them called ``RUN``,
``A``, ``B`` and ``DIR`` as in the pages. Runs with ``make test-all``: the larger families take most of a minute.
"""

from __future__ import annotations

import gzip
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

import newcomer
from cli.test_newcomer import AT_FIRST
from command_line import Cli
from extras import need
from pix2pred.registry import Registry
from pix2pred.vlm.model_spec import MadeSpec, ModelSpec
from test_commands import PAGES, commands

pytestmark = need("matplotlib", extra="plot")

ELSEWHERE = {
    "your_own_data.md": "followed to the letter by test_docs.py",
    "your_own_domain.md": "followed by test_your_own_domain.py",
    "cleanup_juice.md": "minutes of simulation; benchmarks/robot_domains.py",
    "domains.md": "minutes of simulation; tests/domains",
    "robots.md": "needs a robot or its simulator; tests/robots",
    "distil.md": "needs a run to be taught by; tests/cli/test_distil.py",
    "cluster.md": "needs a cluster; tests/cluster",
    "mailbox.md": "answered by a person; tests/cli/test_models.py",
}
"""Pages of which nothing is run here."""

LEFT_OUT = {
    "pix2pred demo": "a minute each; test_recordings.py and 'make wheel' run it",
    "pix2pred review": "serves until it is ended; tests/review",
    "pix2pred mcp": "serves until it is ended; test_serving.py",
    "pix2pred import": "of files that a page does not show; tests/demos/importers",
    "pix2pred bench": "minutes; tests/benchmark, and 'make bench-smoke'",
    "pix2pred doctor --vlm": "asks a model; tests/vlm",
    "pix2pred solve RUN --vlm MODEL": "a pattern: MODEL is no model",
    "pix2pred plan RUN --vlm MODEL": "a pattern: MODEL is no model",
    "pix2pred plan RUN --task DIR --interactive": "asks a person; tests/cli/test_plan.py",
    "pix2pred answers list": "in part; tests/cli/test_sources.py",
    "pix2pred init my-project": "asks at a terminal; tests/cli/test_bring.py",
    "pix2pred learn D": "minutes; docs/results.md says when it was run",
    "pix2pred solve R ": "minutes; docs/results.md says when it was run",
    "pix2pred generate kitchen": "needs the extra sim; tests/domains",
    "pix2pred generate coffee": "needs the extra sim; tests/domains",
    "pix2pred select tests/data": "tests/paper",
    "pix2pred learn --resume RUN": "in the middle of a sentence about corrections; tests/cli",
    "pix2pred select": "in part",
    "pix2pred schema": "in part",
}
"""Beginnings of commands that are not run, each with its reason; what is listed in ``RUN_ALL_THE_SAME`` is."""
RUN_ALL_THE_SAME = (
    "pix2pred select labels.json.gz --out selection.json --pddl pddl",
    "pix2pred select traces.json --out selection.json",
    "pix2pred schema --out DIR",
)
CODES = {"pix2pred check tea": 2, "pix2pred check breakfast": 2, "pix2pred check DIR": 2}
"""Templates have something to fill in."""


class WithPerson(Registry):
    """What is installed, and a person called ``any``."""

    def model_spec(self, text: str) -> ModelSpec:
        person = newcomer.Person(unseen=AT_FIRST)
        return MadeSpec(lambda _: person, text) if text == "any" else super().model_spec(text)


def run_here(page: str) -> Iterator[str]:
    """The commands of a page that can be run, each once."""
    for command in dict.fromkeys(commands(page)):
        if command in RUN_ALL_THE_SAME or not any(command.startswith(begin) for begin in LEFT_OUT):
            yield command


@pytest.fixture(scope="module")
def begun(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a person has who begins to follow a page."""
    from pix2pred.cli.app import run

    folder = tmp_path_factory.mktemp("work")
    photos = newcomer.draw(folder / "photos")
    begin = ["init", str(folder / "data/tea"), "--from-photos", str(photos), *newcomer.DECLARED]
    assert run(begin) == 0
    newcomer.fill_in(folder / "data/tea/demos/photos/demo.yaml")
    (folder / "data/tea/demos/photos").rename(folder / "data/tea/demos/tea")
    learn = ["learn", str(folder / "data/tea"), "--vlm", "any", "--out", str(folder / "runs/tea")]
    assert run(learn, WithPerson()) == 0
    for name in ("RUN", "A", "B"):
        shutil.copytree(folder / "runs/tea", folder / name)
    for name in ("scene.jpg", "table.jpg"):
        shutil.copy(photos / "0.jpg", folder / name)
    traces = (folder / "runs/tea/labels/traces.json").read_bytes()
    (folder / "traces.json").write_bytes(traces)
    (folder / "labels.json.gz").write_bytes(gzip.compress(traces))
    told = ["plan", str(folder / "runs/tea"), "--photo", str(folder / "scene.jpg"), "--goal", "In(ice, glass)"]
    assert run([*told, "--out", str(folder / "DIR0")], WithPerson()) == 0
    for name in ("domain.pddl", "problem.pddl"):
        shutil.copy(folder / "DIR0" / name, folder / name)
    task = folder / "DIR/images/0"
    task.mkdir(parents=True)
    shutil.copy(photos / "0.jpg", task / "main.jpg")
    objects = "".join(f"  {name}: {{type: {name}}}\n" for name in ("hand", "teabag", "ice", "glass", "plate"))
    objects = objects.replace("{type: ice}", "{type: ice, descriptor: two pieces of ice}")
    head = "format: pix2pred-task\nversion: 1\ngoal: ['In(ice, glass)']\nobjects:\n"
    (folder / "DIR/task.yaml").write_text(head + objects)
    return folder


@pytest.fixture
def work(begun: Path, tmp_path: Path) -> Path:
    """The folder in which a person follows one page: another page may make things of the same names."""
    return shutil.copytree(begun, tmp_path / "work")


@pytest.mark.parametrize("page", [p for p in PAGES if p.name not in ELSEWHERE], ids=lambda p: p.name)
def test_commands_of_a_page_run_as_printed(
    page: Path, work: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(work)
    cli = Cli(lambda: (read := capfd.readouterr()) and (read.out, read.err), WithPerson())
    for command in run_here(page.read_text(encoding="utf-8")):
        ran = cli(*shlex.split(command)[1:])
        expected = (0, 1) if "--disturb" in command else (CODES.get(command, 0),)
        assert ran.code in expected, f"$ {command}\n{ran.out}\n{ran.err}"


def test_every_exclusion_is_of_a_command_that_a_page_prints() -> None:
    texts = [page.read_text(encoding="utf-8") for page in PAGES if page.name not in ELSEWHERE]
    printed = [command for text in texts for command in commands(text)]
    assert {begin for begin in LEFT_OUT if not any(c.startswith(begin) for c in printed)} == set()
    assert {name for name in ELSEWHERE if not any(page.name == name for page in PAGES)} == set()
    assert sum(len(list(run_here(text))) for text in texts) >= 20
