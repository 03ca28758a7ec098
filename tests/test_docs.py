"""The tutorial, followed to the letter from an empty folder: files saved, commands run, outputs compared."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from doc_runner import Command, Follower, SavedFile, matches, parts
from notebook import printed
from pix2pred.domains.burger import BurgerDomain
from pix2pred.domains.burger.families import BurgerFamily
from pix2pred.vlm.mailbox import MailboxVLM

DOCS = Path(__file__).parents[1] / "docs"


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draws only the demonstrations that the page uses, and looks into mailboxes more often; changes no output."""
    whole = BurgerDomain._family

    def cut(self: BurgerDomain, name: str) -> BurgerFamily:
        family = whole(self, name)
        return replace(family, demonstrations=family.demonstrations[:4])

    monkeypatch.setattr(BurgerDomain, "_family", cut)
    monkeypatch.setattr(MailboxVLM.__init__, "__kwdefaults__", {"poll": 0.02, "estimate": None})


def test_the_tutorial_says_what_happens(
    quick: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")

    def read() -> tuple[str, str]:
        captured = capfd.readouterr()
        return captured.out, captured.err

    with Follower(read) as follower:
        assert follower.follow((DOCS / "your_own_data.md").read_text()) >= 12
    assert "(pick-item " in (tmp_path / "runs/kitchen/plans/new/plan.txt").read_text()


def test_pages_are_taken_apart() -> None:
    page = (
        "Save this as `a/b.txt`:\n\n```\nhello\n```\n\nNot a file:\n\n```yaml\nx: 1\n```\n\n"
        "```console\n$ cat a/b.txt \\\n    --\nhello\n$ true\n```\n"
    )
    assert list(parts(page)) == [
        SavedFile("a/b.txt", "hello\n"),
        Command("cat a/b.txt --", ("hello",)),
        Command("true", ()),
    ]


@pytest.mark.parametrize(
    ("expected", "printed", "same"),
    [
        (("a", "...", "c"), ["a", "b", "b", "c"], True),
        (("a", "...", "c"), ["a", "c"], True),
        (("a", "...", "c"), ["a", "b"], False),
        ((), ["a"], False),
        (("a",), ["a", "b"], False),
    ],
)
def test_dots_stand_for_lines(expected: tuple[str, ...], printed: list[str], same: bool) -> None:
    assert matches(expected, printed) is same


def test_the_notebook_prints_what_it_shows(quick: None) -> None:
    notebook = json.loads((DOCS / "quickstart.ipynb").read_text())
    shown = [["".join(o["text"]) for o in c["outputs"]] for c in notebook["cells"] if c["cell_type"] == "code"]
    assert [[text] if text else [] for _, text in printed(notebook)] == shown
    assert any("Cook(robot, patty1, grill)" in text for texts in shown for text in texts)
