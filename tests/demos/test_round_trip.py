"""Projects written and read back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pix2pred.demos import FolderError, Project, check_project, read_project, read_tasks, write_project, write_task
from pix2pred.structs import (
    Action,
    Box,
    Demo,
    FromDomain,
    FromFeatures,
    FromHuman,
    FromSkills,
    FromVLM,
    Image,
    Object,
    Picture,
    Predicate,
    Skill,
    SkillTrigger,
    State,
    Task,
    Type,
    Vocabulary,
)
from pix2pred.structs.environment import SimulatedTask
from pix2pred.structs.goals.opposites import opposite

THING = Type("thing")
ROBOT = Type("robot", ("fingers",), THING)
CUP = Type("cup", ("x", "y"), THING)
ON = Predicate("On", (CUP, THING), FromDomain())
FULL = Predicate("Full", (CUP,), FromHuman())
EMPTY = Predicate("NoCupLeft", (), FromVLM("no_cup_left"))
HOLDING = Predicate("Holding", (CUP,), FromSkills((SkillTrigger("Pick", (1,)),), (SkillTrigger("Push", (0,)),)))
OPEN = Predicate("Open", (ROBOT,), FromFeatures("(<= robot.fingers 0.5)"))
PICK = Skill("Pick", (ROBOT, CUP))
PUSH = Skill("Push", (CUP,), (-1.0, -1e-9), (1.0, 2.5))
VOCABULARY = Vocabulary("cups", (THING, ROBOT, CUP), (PICK, PUSH), (ON, FULL, EMPTY, HOLDING, OPEN))
ROBBY = Object("robby", ROBOT, "the robot")
A, B = Object("a", CUP, "red cup"), Object("b-2", CUP, 'blue: cup, "big" # ü 🙂')


def image(seed: int = 0, size: int = 12) -> Image:
    return Image.from_pixels(np.random.default_rng(seed).integers(0, 255, (size, size, 3), dtype=np.uint8))


def demo(name: str = "one", cup: Object = A, x: float = 0.25) -> Demo:
    boxes = {cup.name: Box(0, 1.5, 12, 11), "robby": Box(1, 1, 2, 2)}
    features: Mapping[Object, tuple[float, ...]] = {ROBBY: (1.0,), cup: (x, -3.0), B: (0.0, 1e-7)}
    start = State((Picture("main", image(1), boxes), Picture("0", image(2))), features, frozenset({ON(cup, B)}))
    end = replace(start, given=frozenset({FULL(cup), ON(cup, B), ON(B, cup), EMPTY()}))
    actions = (Action(PICK, (ROBBY, cup)), Action(PUSH, (B,), (x / 2, 1 / 3)))
    return Demo(name, (ROBBY, cup, B), (start, start, end), actions, (FULL(cup), ON(B, cup)))


def task(name: str = "t1") -> SimulatedTask:
    objects = (A, ROBBY, Object("c", CUP, "green cup"))
    features: Mapping[Object, tuple[float, ...]] = {o: (0.5,) * len(o.type.features) for o in objects}
    state = State((Picture("main", image(3)),), features, frozenset({ON(A, objects[2])}))
    return SimulatedTask(Task(name, objects, state, (FULL(A),)), {"seed": 3, "cells": [[1, 2], [3, 4]]})


def files(directory: Path) -> dict[str, bytes]:
    return {str(p.relative_to(directory)): p.read_bytes() for p in directory.rglob("*") if p.is_file()}


def test_a_project_reads_back_equal(tmp_path: Path) -> None:
    demos = (demo("demo-2"), demo("demo-10", x=-1.0))
    learning = {"j_threshold": 2000, "rate": 0.5, "deep": {"names": ["On", "no", "1e3", "", "null"], "none": None}}
    simulator = {"domain": "burger", "family": "more-stacks"}
    write_project(tmp_path / "p", VOCABULARY, demos, [task()], simulator, learning)
    assert read_project(tmp_path / "p") == Project(VOCABULARY, demos, learning, simulator)
    assert [p.source for p in read_project(tmp_path / "p").vocabulary.initial] == [p.source for p in VOCABULARY.initial]
    (stored,) = read_tasks(tmp_path / "p", VOCABULARY)
    assert (stored.task, stored.simulator) == (task().task, task().simulator)
    assert check_project(tmp_path / "p") == []


def test_goals_with_not_and_or_read_back_equal(tmp_path: Path) -> None:
    ways = (opposite(FULL)(B), FULL(A)), (ON(B, A), opposite(EMPTY)())
    several = replace(demo(), goal=ways[0], alternatives=ways[1:])
    write_project(tmp_path / "p", VOCABULARY, [several, replace(demo("two"), goal=ways[0])])
    assert read_project(tmp_path / "p").demos == (several, replace(demo("two"), goal=ways[0]))


def test_camera_order_and_action_parameters_survive(tmp_path: Path) -> None:
    write_project(tmp_path / "p", VOCABULARY, [demo()])
    (read,) = read_project(tmp_path / "p").demos
    assert [p.camera for p in read.states[0].pictures] == ["main", "0"]
    assert read.actions[1].params == (0.125, 1 / 3)


def test_pictures_are_kept_byte_by_byte(tmp_path: Path) -> None:
    write_project(tmp_path / "p", VOCABULARY, [demo()])
    assert (tmp_path / "p/demos/one/images/0/main.png").read_bytes() == image(1).encoded


def test_objects_that_differ_between_demos_are_kept_apart(tmp_path: Path) -> None:
    demos = (demo("x"), demo("y", cup=Object("a", CUP, "orange cup")))
    write_project(tmp_path / "p", VOCABULARY, demos)
    assert read_project(tmp_path / "p").demos == demos


def test_equal_content_gives_equal_bytes(tmp_path: Path) -> None:
    for name in ("p", "q"):
        write_project(tmp_path / name, VOCABULARY, [demo(), demo("two")], [task()], None, {"b": 1, "a": 2})
    assert files(tmp_path / "p") == files(tmp_path / "q")


def test_the_text_is_what_a_person_would_write(tmp_path: Path) -> None:
    write_project(tmp_path / "p", VOCABULARY, [demo()])
    text = (tmp_path / "p/demos/one/demo.yaml").read_text(encoding="utf-8")
    assert text.startswith(
        "format: pix2pred-demo\nversion: 1\nobjects: [robby, a, b-2]\n"
        'goal: ["Full(a)", "On(b-2, a)"]\nactions: ["Pick(robby, a)", "Push(b-2)[0.125, 0.3333333333333333]"]\n'
        "states:\n- features:\n    robby: [1]\n    a: [0.25, -3]\n"
    )


def test_nothing_is_left_beside_the_project(tmp_path: Path) -> None:
    write_project(tmp_path / "p", VOCABULARY, [demo()])
    write_project(tmp_path / "p", VOCABULARY, [demo("other")], overwrite=True)
    assert [p.name for p in tmp_path.iterdir()] == ["p"]


def test_other_folders_are_never_overwritten(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("years of work")
    with pytest.raises(FolderError, match="no project"):
        write_project(tmp_path, VOCABULARY, [demo()], overwrite=True)
    assert [p.name for p in tmp_path.iterdir()] == ["thesis.txt"]


def test_overwriting_is_asked_for_and_keeps_other_files(tmp_path: Path) -> None:
    write_project(tmp_path / "p", VOCABULARY, [demo("old")], [task()])
    (tmp_path / "p/notes.txt").write_text("mine")
    before = files(tmp_path / "p")
    with pytest.raises(FolderError, match="overwrite"):
        write_project(tmp_path / "p", VOCABULARY, [demo("new")])
    assert files(tmp_path / "p") == before
    write_project(tmp_path / "p", VOCABULARY, [demo("new")], overwrite=True)
    assert [d.name for d in read_project(tmp_path / "p").demos] == ["new"]
    assert read_tasks(tmp_path / "p", VOCABULARY) == ()
    assert (tmp_path / "p/notes.txt").read_text() == "mine"


def test_a_project_read_lazily_can_be_written_over_itself(tmp_path: Path) -> None:
    write_project(tmp_path / "p", VOCABULARY, [demo()])
    write_project(tmp_path / "p", VOCABULARY, read_project(tmp_path / "p").demos, overwrite=True)
    assert read_project(tmp_path / "p").demos == (demo(),)


@pytest.mark.parametrize("name", ["../out", "a/b", "..", "", ".hidden", "a\nb", "x" * 200])
def test_names_that_are_no_folder_names_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(FolderError, match="name"):
        write_project(tmp_path / "p", VOCABULARY, [demo(name)])
    with pytest.raises(FolderError, match="name"):
        write_task(tmp_path / "p", VOCABULARY, task(name))
    assert list(tmp_path.iterdir()) == []


def test_names_equal_but_for_case_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FolderError, match="case"):
        write_project(tmp_path / "p", VOCABULARY, [demo("one"), demo("ONE")])


def test_a_camera_cannot_leave_the_folder(tmp_path: Path) -> None:
    escaping = replace(demo(), states=tuple(State((Picture("../../x", image()),)) for _ in range(3)))
    with pytest.raises(FolderError, match="camera"):
        write_project(tmp_path / "p", VOCABULARY, [escaping])
    assert list(tmp_path.iterdir()) == []


def test_what_could_not_be_read_is_not_written(tmp_path: Path) -> None:
    early = replace(demo(), goal=(ON(A, B),))
    with pytest.raises(FolderError, match="already holds") as caught:
        write_project(tmp_path / "p", VOCABULARY, [early])
    assert caught.value.problems[0].file == tmp_path / "p/demos/one/demo.yaml"
    with pytest.raises(FolderError, match="finite"):
        write_project(tmp_path / "p", VOCABULARY, [demo(x=float("nan"))])
    with pytest.raises(FolderError, match="no demonstration"):
        write_project(tmp_path / "p", VOCABULARY, [])
    assert list(tmp_path.iterdir()) == []


def test_a_task_stands_alone(tmp_path: Path) -> None:
    write_task(tmp_path / "p", VOCABULARY, task("t10"))
    write_task(tmp_path / "p", VOCABULARY, task("t9"))
    assert [s.task.name for s in read_tasks(tmp_path / "p", VOCABULARY)] == ["t9", "t10"]
    with pytest.raises(FolderError, match="exists already"):
        write_task(tmp_path / "p", VOCABULARY, task("t9"))
    write_task(tmp_path / "p", VOCABULARY, task("t9"), overwrite=True)


def test_the_simulator_file_changes_nothing_a_solver_sees(tmp_path: Path) -> None:
    write_task(tmp_path / "p", VOCABULARY, task())
    (with_file,) = read_tasks(tmp_path / "p", VOCABULARY)
    with_file.simulator_path.unlink()
    (without,) = read_tasks(tmp_path / "p", VOCABULARY)
    assert without.simulator is None
    assert without.task == with_file.task


def test_a_jpeg_stays_a_jpeg(tmp_path: Path) -> None:
    import io

    import PIL.Image

    buffer = io.BytesIO()
    PIL.Image.fromarray(image().pixels()).save(buffer, "JPEG")
    states = tuple(replace(s, pictures=(Picture("cam", Image(buffer.getvalue())),)) for s in demo().states)
    written = replace(demo(), states=states)
    write_project(tmp_path / "p", VOCABULARY, [written])
    assert (tmp_path / "p/demos/one/images/2/cam.jpg").read_bytes() == buffer.getvalue()
    assert read_project(tmp_path / "p").demos == (written,)


@settings(max_examples=25, deadline=None)
@given(
    x=st.floats(-1, 1),
    y=st.floats(allow_nan=False, allow_infinity=False),
    descriptor=st.text(min_size=1, max_size=30).filter(
        lambda s: s.isprintable() and s.strip() not in ("", "the_robot")
    ),
)
def test_any_number_and_descriptor_survives(
    tmp_path_factory: pytest.TempPathFactory, x: float, y: float, descriptor: str
) -> None:
    cup = Object("a", CUP, descriptor)
    made = demo(cup=cup)
    features = {ROBBY: (y,), cup: (x, y), B: (0.0, 0.0)}
    states = tuple(State((), features, s.given) for s in made.states)
    made = replace(made, states=states, actions=(made.actions[0], Action(PUSH, (B,), (x, 1.0))))
    folder = tmp_path_factory.mktemp("any") / "p"
    write_project(folder, VOCABULARY, [made])
    assert read_project(folder).demos == (made,)
