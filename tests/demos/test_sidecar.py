"""Side-car files: three forms of one thing, and what is wrong with them by line."""

from __future__ import annotations

from pathlib import Path

import pytest

from pix2pred.demos import FolderError
from pix2pred.demos.files.sidecar import clock, demo_name, read_sidecar

YAML = """\
format: pix2pred-import
version: 1
demos:
- name: tea-1
  from: kitchen.mp4
  goal: ["Full(mug)"]
  start: 0.5
  steps:
  - {do: "Pick(robot, mug)", until: 3.25}
  - {do: "Pour(mug)", until: 72}
- name: tea-2
  from: 3
  objects: [mug]
  steps:
  - {do: TODO}
"""
CSV = """\
demo,from,seconds,action
tea-1,kitchen.mp4,0.5,
tea-1,,3.25,"Pick(robot, mug)"
tea-1,,1:12,Pour(mug)

tea-2,3,4,TODO
"""


def write(folder: Path, name: str, text: str) -> Path:
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


@pytest.mark.parametrize(("name", "text"), [("a.yaml", YAML), ("a.csv", CSV), ("a.CSV", "\ufeff" + CSV)])
def test_a_table_says_what_yaml_says(tmp_path: Path, name: str, text: str) -> None:
    one, two = read_sidecar(write(tmp_path, name, text))
    assert (one.doc.name, one.doc.source, one.moments()) == ("tea-1", "kitchen.mp4", (0.5, 3.25, 72.0))
    assert [s.do for s in one.doc.steps] == ["Pick(robot, mug)", "Pour(mug)"]
    assert (two.doc.name, two.doc.source) == ("tea-2", 3)
    assert one.problem(("steps", 1), "").line == (10 if name == "a.yaml" else 4)


def test_a_list_of_actions_has_no_times(tmp_path: Path) -> None:
    (segment,) = read_sidecar(write(tmp_path, "make tea.txt", "# first\nPick(robot, mug)\n\nPour(mug)[3, 4]\n"))
    assert segment.doc.name == "make-tea" and not segment.has_moments()
    assert [s.do for s in segment.doc.steps] == ["Pick(robot, mug)", "Pour(mug)[3, 4]"]
    assert segment.problem(("steps", 1), "").line == 4


@pytest.mark.parametrize(
    ("name", "text", "line", "message"),
    [
        ("a.txt", "# nothing\n", None, "names no action"),
        ("a.csv", "", 1, "seconds, action is missing"),
        ("a.csv", "seconds,what\n1,Pick(a)\n", 1, "action is missing"),
        ("a.csv", "seconds,action\n1,Pick(a, b)\n", 2, "double quotes"),
        ("a.csv", "seconds,action\nsoon,Pick(a)\n", 2, "'soon' is no time"),
        ("a.csv", "seconds,action\n-1,Pick(a)\n", 2, "is no time"),
        ("a.csv", "seconds,action\n1,Pick(a)\n2,\n", 3, "only the first row"),
        ("a.csv", "seconds,action\n1,\n", None, "has no action"),
        ("a.csv", "seconds,action\n1,\"" + "x" * 200_000, 1, "not a table"),
        ("a.json", "{}", None, "write a .yaml, .csv or .txt"),
        ("a.yaml", YAML.replace("name: tea-2", "name: ../tea"), 11, "not a valid name"),
        ("a.yaml", YAML.replace("name: tea-2", "name: Tea-1"), 11, "there twice"),
        ("a.yaml", YAML.replace("until: 72", "until: -72"), 10, "greater than or equal to 0"),
        ("a.yaml", YAML.replace("until: 72", "til: 72"), 10, "did you mean 'until'?"),
        ("a.yaml", YAML.replace("  steps:\n  - {do: TODO}", "  steps: []"), 14, "at least 1"),
    ],
)  # fmt: skip
def test_what_is_wrong_has_a_line(tmp_path: Path, name: str, text: str, line: int | None, message: str) -> None:
    with pytest.raises(FolderError) as caught:
        read_sidecar(write(tmp_path, name, text))
    assert (caught.value.problems[0].line, message in str(caught.value)) == (line, True), str(caught.value)


def test_times_go_forward(tmp_path: Path) -> None:
    (one, _) = read_sidecar(write(tmp_path, "a.yaml", YAML.replace("until: 72", "until: 3")))
    with pytest.raises(FolderError, match=r"a.yaml:10: is done at 3, before it begins \(3.25\)"):
        one.moments()
    (_, two) = read_sidecar(tmp_path / "a.yaml")
    with pytest.raises(FolderError, match=r"a.yaml:15: 'until' is missing"):
        two.moments()


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"\x00" * 100])
@pytest.mark.parametrize("name", ["a.yaml", "a.csv", "a.txt"])
def test_junk_is_one_error(tmp_path: Path, name: str, content: bytes) -> None:
    (tmp_path / name).write_bytes(content)
    if name == "a.txt" and content[0] == 0:
        return  # text of a kind: one action that no skill has
    with pytest.raises(FolderError):
        read_sidecar(tmp_path / name)


def test_times_and_names() -> None:
    assert [clock(t) for t in ("7", "0:07.5", "1:00:00", "1:2:3:4", "", "٣", "1e3", "nan")] == [
        7.0, 7.5, 3600.0, None, None, None, None, None,
    ]  # fmt: skip
    assert demo_name("../../etc/passwd") == "etc-passwd"
    assert demo_name("") == demo_name("…") == "demo"
    assert demo_name("a", ["A", "a-2"]) == "a-3"
    assert len(demo_name("x" * 500)) <= 100
