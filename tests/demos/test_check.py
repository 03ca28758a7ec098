"""Every kind of problem, with the file and line where it is."""

from __future__ import annotations

import io
import os
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
import yaml

from pix2pred.demos import FolderError, Problem, check_project, read_project, read_tasks

DOMAIN = """\
format: pix2pred-domain
version: 1
name: cups
types:
- {name: thing}
- {name: robot, parent: thing}
- {name: cup, parent: thing, features: [x, y]}
objects:
  a: {type: cup, descriptor: red cup}
  b: {type: cup}
  robby: {type: robot}
skills:
- {name: Pick, types: [robot, cup]}
- {name: Push, types: [cup], low: [0, 0], high: [1, 1]}
predicates:
- {name: On, types: [cup, thing]}
- {name: Full, types: [cup], source: human}
- {name: Hot, types: [cup], source: vlm}
- name: Held
  types: [cup]
  source: skills
  set_by: [{skill: Pick, args: [1]}]
"""
DEMO = """\
format: pix2pred-demo
version: 1
objects: [a, b, robby]
goal: ["On(a, b)"]
actions:
- Pick(robby, a)
- Push(a)[0.5, 1]
states:
- features: {a: [0, 1], b: [2, 3]}
  given: []
  pictures: {main: {a: [0, 0, 4, 4]}}
- features: {a: [0, 1], b: [2, 3]}
  given: [Full(a), Full(b)]
  pictures: {main: {}}
- features:
    a: [0, 1]
    b: [2, 3]
  given:
  - Full(a)
  - On(a, b)
  pictures:
    main:
      a: [1, 1, 8, 8]
"""
TASK = """\
format: pix2pred-task
version: 1
objects:
  a: {type: cup}
  z: {type: cup, descriptor: tall cup}
goal: ["Full(z)"]
state:
  given: ["On(a, z)"]
"""


def png(width: int = 10, height: int = 8) -> bytes:
    buffer = io.BytesIO()
    PIL.Image.fromarray(np.zeros((height, width, 3), np.uint8)).save(buffer, "PNG")
    return buffer.getvalue()


@pytest.fixture
def project(tmp_path: Path) -> Path:
    root = tmp_path / "cups"
    for t in range(3):
        (root / f"demos/d1/images/{t}").mkdir(parents=True)
        (root / f"demos/d1/images/{t}/main.png").write_bytes(png())
    (root / "tasks/t1/images/0").mkdir(parents=True)
    (root / "tasks/t1/images/0/main.png").write_bytes(png())
    (root / "domain.yaml").write_text(DOMAIN)
    (root / "demos/d1/demo.yaml").write_text(DEMO)
    (root / "tasks/t1/task.yaml").write_text(TASK)
    return root


def edit(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))


def only(root: Path) -> Problem:
    problems = check_project(root)
    assert len(problems) == 1, [str(p) for p in problems]
    return problems[0]


def test_a_sound_project_has_no_problems(project: Path) -> None:
    assert check_project(project) == []
    assert [d.name for d in read_project(project).demos] == ["d1"]


DOMAIN_PROBLEMS = [
    ("parent: thing, features", "parent: thimg, features", 7, "type 'thimg' is not declared; did you mean 'thing'?"),
    ("{name: thing}", "{name: thing, parent: cup}", 5, "its own ancestor"),
    ("- {name: robot,", "- {name: thing}\n- {name: robot,", 6, "type 'thing' is declared twice (first on line 5)"),
    ("[x, y]", "[x, x]", 7, "distinct"),
    ("descriptor: red cup}", "descriptor: red cup, color: red}", 9, "unknown key 'color'"),
    ("b: {type: cup}", "b: {type: cap}", 10, "did you mean 'cup'?"),
    ("b: {type: cup}", "b c: {type: cup}", 10, "not a valid name"),
    ("b: {type: cup}", "b: {type: cup}\n  b: {type: cup}", 11, "twice"),
    ("types: [robot, cup]}", "types: [robot, cpu]}", 13, "did you mean 'cup'?"),
    ("low: [0, 0]", "low: [0]", 14, "low and high"),
    ("low: [0, 0]", "low: [.nan, 0]", 14, "not a number"),
    ("types: [cup, thing]}", "types: [cup, thin]}", 16, "did you mean 'thing'?"),
    ("source: human", "source: people", 17, "'human'"),
    ("source: vlm", "source: features", 18, "expression"),
    ("{skill: Pick, args: [1]}", "{skill: Pik, args: [1]}", 22, "did you mean 'Pick'?"),
    ("{skill: Pick, args: [1]}", "{skill: Pick, args: [0]}", 22, "is a robot, not a cup"),
    ("{skill: Pick, args: [1]}", "{skill: Pick, args: [2]}", 22, "no argument 2"),
    ("{skill: Pick, args: [1]}", "{skill: Pick, args: [1, 0]}", 22, "takes 1 arguments"),
    ("version: 1", "version: 2", 2, "version is 2"),
    ("version: 1", "version: '1'", 2, "version"),
    ("version: 1", "version: true", 2, "version"),
    ("format: pix2pred-domain", "format: pix2pred-demo", 1, "format: pix2pred-domain"),
    ("name: cups\n", "name: cups\nlerning: {}\n", 4, "did you mean 'learning'?"),
    ("name: cups\n", "name: [cups]\n", 3, "expected text"),
    ("name: cups\n", "name: cups\nsimulator: {domain: burger}\n", 4, "'family' is missing"),
]


@pytest.mark.parametrize(("old", "new", "line", "message"), DOMAIN_PROBLEMS, ids=lambda value: str(value)[:40])
def test_problems_of_the_domain(project: Path, old: str, new: str, line: int, message: str) -> None:
    edit(project / "domain.yaml", old, new)
    problem = check_project(project)[0]
    assert (problem.file, problem.line) == (project / "domain.yaml", line), str(problem)
    assert message in problem.message


DEMO_PROBLEMS = [
    ("[a, b, robby]", "[a, b, roby]", 3, "did you mean 'robby'?"),
    ("[a, b, robby]", "[a, b, robby, a]", 3, "listed twice"),
    ("[a, b, robby]", "everything", 3, "expected a list"),
    ("[a, b, robby]", "{a: {type: cup}, b: {type: cup, descriptor: a}, robby: {type: robot}}", 3, "both called"),
    ("[a, b, robby]", "{a: {type: cup}, b: {typ: cup}, robby: {type: robot}}", 3, "'type' is missing"),
    ('["On(a, b)"]', "[]", 4, "needs a goal"),
    ('["On(a, b)"]', '["Onn(a, b)"]', 4, "predicate 'Onn' is not declared; did you mean 'On'?"),
    ('["On(a, b)"]', '["On(a)"]', 4, "takes 2 arguments, found 1"),
    ('["On(a, b)"]', '["On(robby, b)"]', 4, "robby is a robot, not a cup"),
    ('["On(a, b)"]', '["On(a, c)"]', 4, "object 'c' is not declared"),
    ('["On(a, b)"]', "[On(a, b)]", 4, "quotes"),
    ('["On(a, b)"]', '["On(a, b)", "On(b, a)"]', 4, "not among the given atoms of the last state"),
    ('["On(a, b)"]', "[5]", 4, "expected text"),
    ("- Pick(robby, a)", "- Pck(robby, a)", 6, "did you mean 'Pick'?"),
    ("- Pick(robby, a)", "- Pick(a, robby)", 6, "a is a cup, not a robot"),
    ("- Pick(robby, a)", "- Pick(robby, a)[1]", 6, "takes 0 continuous parameters, found 1"),
    ("- Push(a)[0.5, 1]", "- Push(a)", 7, "takes 2 continuous parameters, found 0"),
    ("- Push(a)[0.5, 1]", "- Push(a)[0.5, 1", 7, "']' is missing"),
    ("- Push(a)[0.5, 1]", "- Push(a)[0.5, x]", 7, "expected numbers"),
    ("- Push(a)[0.5, 1]", "- Push(a)[0.5, nan]", 7, "finite"),
    ("- Push(a)[0.5, 1]", "- Push(a)[0.5, 1.5]", 7, "outside [0.0, 1.0]"),
    ("- Push(a)[0.5, 1]\n", "", 7, "1 actions need 2 states, found 3"),
    ("{a: [0, 1], b: [2, 3]}", "{a: [0, 1], b: [2]}", 9, "features [x, y], found 1"),
    ("{a: [0, 1], b: [2, 3]}", "{a: [0, .nan], b: [2, 3]}", 9, "finite"),
    ("{a: [0, 1], b: [2, 3]}", "{a: [0, yes], b: [2, 3]}", 9, "number"),
    ("{a: [0, 1], b: [2, 3]}", "{a: [0, true], b: [2, 3]}", 9, "number"),
    ("{a: [0, 1], b: [2, 3]}", "{a: [0, 1]}", 9, "missing for b"),
    ("{a: [0, 1], b: [2, 3]}", "{a: [0, 1], b: [2, 3], q: [1]}", 9, "object 'q' is not declared"),
    ("    a: [0, 1]\n    b: [2, 3]\n", "    {}\n", 15, "every state or in none"),
    ("given: []", 'given: ["On(a, b)"]', 9, "already holds at the start"),
    ("given: [Full(a), Full(b)]", 'given: ["On(a, b)"]', 12, "already holds in state 1"),
    ("  - Full(a)\n", "  - Ful(a)\n", 19, "did you mean 'Full'?"),
    ("  - On(a, b)\n", "  - Full(b)\n", 4, "not among the given atoms"),
    ("      a: [1, 1, 8, 8]", "      a: [1, 1, 11, 8]", 23, "leaves the picture, which is 10x8"),
    ("      a: [1, 1, 8, 8]", "      a: [-1, 1, 8, 8]", 23, "leaves the picture"),
    ("      a: [1, 1, 8, 8]", "      a: [8, 1, 1, 8]", 23, "inverted"),
    ("      a: [1, 1, 8, 8]", "      a: [1, 1, 8]", 23, "4 numbers"),
    ("      a: [1, 1, 8, 8]", "      a: [1, 1, 8, .inf]", 23, "finite"),
    ("      a: [1, 1, 8, 8]", "      aa: [1, 1, 8, 8]", 23, "object 'aa' is not declared; did you mean 'a'?"),
    ("    main:\n", "    ../../../x:\n", 22, "not a valid name"),
    ("    main:\n", "    man:\n", 22, "did you mean 'main'?"),
    ("states:\n", "statse:\n", 8, "did you mean 'states'?"),
]


@pytest.mark.parametrize(("old", "new", "line", "message"), DEMO_PROBLEMS, ids=lambda value: str(value)[:40])
def test_problems_of_a_demo(project: Path, old: str, new: str, line: int, message: str) -> None:
    file = project / "demos/d1/demo.yaml"
    edit(file, old, new)
    found = [p for p in check_project(project) if message in p.message]
    assert found, [str(p) for p in check_project(project)]
    assert (found[0].file, found[0].line) == (file, line), str(found[0])
    assert str(found[0]).startswith(f"{file}:{line}: ")


def test_reading_raises_all_problems_at_once(project: Path) -> None:
    edit(project / "domain.yaml", "name: On,", "name: Onn,")
    edit(project / "demos/d1/demo.yaml", "- Pick(robby, a)", "- Pck(robby, a)")
    with pytest.raises(FolderError) as caught:
        read_project(project)
    lines = [(p.file.name, p.line) for p in caught.value.problems]
    assert lines == [("demo.yaml", 4), ("demo.yaml", 6), ("demo.yaml", 20)]


def test_uses_of_a_broken_declaration_are_not_reported_again(project: Path) -> None:
    edit(project / "domain.yaml", "types: [cup, thing]}", "types: [cup, thin]}")
    edit(project / "domain.yaml", "b: {type: cup}", "b: {type: cap}")
    assert [p.line for p in check_project(project)] == [10, 16]


def test_a_predicate_that_is_labelled_later_may_be_the_goal(project: Path) -> None:
    edit(project / "demos/d1/demo.yaml", '["On(a, b)"]', '["Hot(a)"]')
    assert check_project(project) == []


def test_an_empty_demo(project: Path) -> None:
    text = DEMO[: DEMO.index("actions:")] + "actions: []\nstates: []\n"
    (project / "demos/d1/demo.yaml").write_text(text)
    messages = [(p.line, p.message) for p in check_project(project) if p.line]
    assert (5, "a demonstration needs at least one action") in messages
    assert (6, "0 actions need 1 states, found 0") in messages


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "no picture"),
        (b"", "is empty, neither PNG nor JPEG"),
        (b"GIF89a" + b"0" * 50, "neither PNG nor JPEG"),
        (b"%!PS-Adobe-3.0 EPSF-3.0", "neither PNG nor JPEG"),
        (png()[:44], "cannot be read"),
        (png()[:30] + b"\xff" * 40, "cannot be read"),
        (b"\xff\xd8\xff\xe0junk", "cannot be read"),
        (png(11, 8), "is 11x8 pixels, earlier pictures of camera 'main' are 10x8"),
        (png(60_000, 1_200), "more than 64000000"),
    ],
)
def test_pictures_that_cannot_be_used(project: Path, content: bytes | None, message: str) -> None:
    picture = project / "demos/d1/images/1/main.png"
    picture.unlink()
    if content is not None:
        picture.write_bytes(content)
    problem = only(project)
    assert message in problem.message
    if content is not None:
        assert problem.file == picture
        read_project(project)  # decodes when used


def test_pictures_are_found_by_themselves(project: Path) -> None:
    for t in range(3):
        (project / f"demos/d1/images/{t}/side.JPG").write_bytes(png())
        (project / f"demos/d1/images/{t}/.DS_Store").write_bytes(b"x")
    text = "\n".join(line for line in DEMO.splitlines()[:-3] if "pictures" not in line)
    (project / "demos/d1/demo.yaml").write_text(text)
    assert check_project(project) == []
    assert [p.camera for p in read_project(project).demos[0].states[2].pictures] == ["main", "side"]
    (project / "demos/d1/images/1/side.JPG").unlink()
    problem = only(project)
    assert problem.line == 11
    assert "cameras of this state are main, those of the first state main, side" in problem.message


def test_pictures_with_unusable_names_or_places(project: Path) -> None:
    images = project / "demos/d1/images"
    (project / "demos/d1/demo.yaml").write_text(DEMO.replace("  pictures: {main: {a: [0, 0, 4, 4]}}\n", ""))
    (images / "0/front view.png").write_bytes(png())
    (images / "0/top.heic").write_bytes(b"")
    (images / "0/main.jpeg").write_bytes(png())
    (images / "7").mkdir()
    (images / "0.png").write_bytes(png())
    messages = "\n".join(str(p) for p in check_project(project))
    for expected in ("front view.png", "only PNG and JPEG", "two pictures", "belongs to no state", "pictures go into"):
        assert expected in messages


def test_links_out_of_the_folder_are_not_followed(project: Path, tmp_path: Path) -> None:
    secret = tmp_path / "secret.png"
    secret.write_bytes(png())
    picture = project / "demos/d1/images/0/main.png"
    picture.unlink()
    picture.symlink_to(secret)
    assert "outside the project" in only(project).message
    picture.unlink()
    picture.symlink_to(picture)
    assert "cannot be opened" in only(project).message
    picture.unlink()
    picture.symlink_to("../1/main.png")
    assert check_project(project) == []


def test_a_demo_that_is_a_link_or_a_pipe(project: Path, tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere/demo.yaml").write_text(DEMO)
    (project / "demos/d2").symlink_to(tmp_path / "elsewhere")
    assert "outside the project" in only(project).message
    (project / "demos/d2").unlink()
    (project / "demos/d2").mkdir()
    os.mkfifo(project / "demos/d2/demo.yaml")
    assert "not a regular file" in only(project).message


def test_folders_that_are_no_project(tmp_path: Path) -> None:
    assert "is not a folder" in only(tmp_path / "nothing").message
    assert check_project(tmp_path)[0].message == "does not exist"
    (tmp_path / "domain.yaml").mkdir()
    assert check_project(tmp_path)[0].message == "is not a regular file"
    with pytest.raises(FolderError):
        read_project(tmp_path)


def test_demo_folders_with_unusable_names(project: Path) -> None:
    (project / "demos/my demo").mkdir()
    (project / "demos/d3").mkdir()
    (project / "demos/demo.yaml").write_text(DEMO)
    messages = "\n".join(str(p) for p in check_project(project))
    assert (
        "'my demo'" in messages and "d3/demo.yaml: does not exist" in messages and "demos/<name>/demo.yaml" in messages
    )


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ('["Full(z)"]', "[]", 6, "needs a goal"),
        ('["Full(z)"]', '["Full(zz)"]', 6, "did you mean 'z'?"),
        ('["Full(z)"]', '["On(a, z)", "Full(z) or not Full(zz)"]', 6, "did you mean 'z'?"),
        ('["Full(z)"]', '["not Full(z) or"]', 6, "at the end of 'not Full(z) or'"),
        ('["Full(z)"]', '["Full(z)", "not Full(z)"]', 6, "the goal can never hold"),
        ('["On(a, z)"]', '["not On(a, z)"]', 8, "only goals may say what must not hold"),
        ('["On(a, z)"]', '["On(a, b)"]', 8, "object 'b' is not declared"),
        ("type: cup, descriptor", "type: cop, descriptor", 5, "did you mean 'cup'?"),
        ("version: 1", "version: 0", 2, "version is 0"),
    ],
)
def test_problems_of_a_task(project: Path, old: str, new: str, line: int, message: str) -> None:
    file = project / "tasks/t1/task.yaml"
    edit(file, old, new)
    problem = only(project)
    assert (problem.file, problem.line) == (file, line)
    assert message in problem.message
    with pytest.raises(FolderError):
        read_tasks(project, read_project(project).vocabulary)


def test_goals_of_tasks_may_say_not_and_or(project: Path) -> None:
    file = project / "tasks/t1/task.yaml"
    edit(file, '["Full(z)"]', '["not On(a, z)", "Full(z) or not (Full(a) or On(z, a))"]')
    vocabulary = read_project(project).vocabulary
    (stored,) = read_tasks(project, vocabulary)
    goals = [[str(atom) for atom in goal] for goal in stored.task.goals]
    assert goals == [["not On(a, z)", "Full(z)"], ["not On(a, z)", "not Full(a)", "not On(z, a)"]]
    doc = yaml.safe_load(file.read_text())
    edit(file, str(doc["goal"][0]), "Full(a)")
    assert len(read_tasks(project, vocabulary)[0].task.goals) == 1, "the other way contradicts it"


def test_goals_of_demonstrations_may_say_not_and_or(project: Path) -> None:
    edit(project / "demos/d1/demo.yaml", '["On(a, b)"]', '["On(a, b) or On(b, a)", "not Full(b) or Full(a)"]')
    (demo,) = read_project(project).demos
    assert [[str(atom) for atom in goal] for goal in demo.goals] == [
        ["On(a, b)", "not Full(b)"], ["On(a, b)", "Full(a)"], ["On(b, a)", "not Full(b)"], ["On(b, a)", "Full(a)"],
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("goal", "line", "message"),
    [
        ("not On(a, b)", 4, "goal atom not On(a, b): On(a, b) is among the given atoms of the last state; a demon"),
        ("On(b, a) or not Full(a)", 4, "On(b, a) is not among the given atoms of the last state (and no other way"),
        ("Hot(a) or On(a, b) or Full(a)", 12, "the goal already holds in state 1"),
        ("not Full(b) and not Full(b)", 9, "the goal already holds at the start"),
        ("On(a, b) and", 4, "at the end of 'On(a, b) and'"),
        ("On(a, b) or On(a, a)", 4, "names one object twice"),
        ("On(a, b) and not On(a, b)", 4, "the goal can never hold"),
    ],
)
def test_a_demonstration_ends_in_one_of_its_goals(project: Path, goal: str, line: int, message: str) -> None:
    edit(project / "demos/d1/demo.yaml", "On(a, b)", goal)
    problem = only(project)
    assert problem.line == line and message in problem.message


@pytest.mark.parametrize("text", ["{", "[1]", "[" * 100_000, '{"a": NaN}', "\x00"])
def test_simulator_files_that_are_no_json_object(project: Path, text: str) -> None:
    (project / "tasks/t1/simulator.json").write_text(text)
    assert only(project).file.name == "simulator.json"


@pytest.mark.parametrize(
    "content", [b"", b"\xff\xfe\x00", b"[" * 5000, b"- 1\n", b"x", b"null", b"a: &b [*b]", b"\x89PNG"]
)
@pytest.mark.parametrize("name", ["domain.yaml", "demos/d1/demo.yaml", "tasks/t1/task.yaml"])
def test_junk_never_raises_from_a_check(project: Path, name: str, content: bytes) -> None:
    (project / name).write_bytes(content)
    problems = check_project(project)
    assert [p.file for p in problems] == [project / name], [str(p) for p in problems]


def test_thousands_of_problems_are_counted(project: Path) -> None:
    edit(project / "demos/d1/demo.yaml", '["On(a, b)"]', "[" + "1, " * 5000 + "]")
    problems = check_project(project)
    assert len(problems) == 101
    assert "4900 more" in problems[-1].message


def test_long_chains_of_types(project: Path) -> None:
    chain = "\n".join(f"- {{name: t{i}, parent: t{i + 1}}}" for i in range(3000))
    edit(project / "domain.yaml", "- {name: thing}", f"- {{name: thing}}\n{chain}\n- {{name: t3000}}")
    assert "ancestors" in check_project(project)[0].message
