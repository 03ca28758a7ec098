"""Label files of the method's authors become the given atoms of imported demonstrations."""

from __future__ import annotations

from pathlib import Path

import pytest

from command_line import Cli
from demos.importers.test_numbered_states import trajectory
from pix2pred.demos import FolderError, read_project
from pix2pred.demos.authoring import declare, domain_text
from pix2pred.demos.importers import with_labels
from pix2pred.demos.importers.frames import drafts_of_frames
from pix2pred.demos.importers.label_file import read_labels

LABELS = """===
{*Held(mug): False.
*In(mug, box): False.} ->

pick(mug, hand)[] ->

{*Held(mug): True.
*In(mug, box): False.} ->

place_in(mug, box)[] ->

{*Held(mug): False.
*In(mug, box): True.}
===
"""


@pytest.fixture
def cli(capfd: pytest.CaptureFixture[str]) -> Cli:
    return Cli(lambda: (read := capfd.readouterr()) and (read.out, read.err))


def test_labels_and_actions_are_read(tmp_path: Path) -> None:
    (tmp_path / "l.txt").write_text(LABELS)
    (one,) = read_labels(tmp_path / "l.txt")
    assert one.actions == ("pick(mug, hand)[]", "place_in(mug, box)[]")
    assert one.states == ((), ("Held(mug)",), ("In(mug, box)",))


@pytest.mark.parametrize(
    "text",
    [LABELS.replace("False.", "False").replace("True.", "True"), LABELS.replace("\n", "\r\n"),
     LABELS.replace("*", "* "),
     LABELS.strip("=\n"), LABELS.replace(".}", ".\n}"), "\ufeff" + LABELS, LABELS.replace(" ->\n\n", "->")],
)  # fmt: skip
def test_other_spacings_are_the_same(tmp_path: Path, text: str) -> None:
    (tmp_path / "l.txt").write_bytes(text.encode())
    (one,) = read_labels(tmp_path / "l.txt")
    assert one.states == ((), ("Held(mug)",), ("In(mug, box)",)) and len(one.actions) == 2


@pytest.mark.parametrize("actions", ["pick(mug, hand, [])\nplace_in(mug, box, [])\n", None])
def test_a_project_with_labels_is_learned_from(cli: Cli, tmp_path: Path, actions: str | None) -> None:
    folder = trajectory(tmp_path / "data" / "traj_0", actions=actions or "")
    if actions is None:
        (folder / "options_traj.txt").unlink()
    (tmp_path / "l.txt").write_text(LABELS)
    words = ["Held(cup) = human", "In(cup, box) = human"]
    declared = declare(["cup", "box", "hand"], ["mug:cup", "box:box", "hand:hand"],
                       ["pick(cup, hand)", "place_in(cup, box)"], words)  # fmt: skip
    (tmp_path / "p").mkdir()
    (tmp_path / "p/domain.yaml").write_text(domain_text("p", declared))
    ran = cli("import", "frames", tmp_path / "data", "--labels", tmp_path / "l.txt", "--out", tmp_path / "p")
    assert ran.code == 0, ran.err
    demo = tmp_path / "p/demos/traj_0/demo.yaml"
    demo.write_text(demo.read_text().replace("- TODO", '- "In(mug, box)"'))
    (read,) = read_project(tmp_path / "p").demos
    assert [sorted(map(str, s.given)) for s in read.states] == [[], ["Held(mug)"], ["In(mug, box)"]]
    assert [a.skill.name for a in read.actions] == ["pick", "place_in"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "holds no labels"),
        ("===\n===\n", "holds no labels"),
        (LABELS.replace("Held(mug): True", "Held(mug): maybe"), r"l\.txt:7: expected a label such as"),
        (LABELS.replace("*Held(mug): True.", "Held"), r"l\.txt:7: expected a label"),
        (LABELS.replace("pick(mug, hand)[] ->\n", ""), r"l\.txt:\d+: states in braces and actions have to follow"),
        (LABELS.replace("pick(mug", "take(mug"), r"labels the action 'take\(mug, hand\)\[\]', where traj_0 has 'pick"),
        (LABELS + LABELS, "labels 2 demonstrations, there are 1: traj_0"),
        (LABELS.partition("place_in")[0].rstrip(" ->\n") + "\n", "labels 1 actions, traj_0 has 2"),
        (LABELS.replace("===\n{", "===\npick(mug, hand)[] -> {"), "states in braces"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "l.txt").write_text(text)
    drafts = drafts_of_frames(trajectory(tmp_path / "data" / "traj_0"))
    with pytest.raises(FolderError, match=message):
        with_labels(tmp_path / "l.txt", drafts)
