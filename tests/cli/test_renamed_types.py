"""Renaming a type asks nothing again: the answers that are stored belong to the same questions under other names."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cli.hostile_lamps import Fake, OneModel, sees, write_lamps
from command_line import Cli
from pix2pred.predicates.frugal.definitions import skill_lines
from pix2pred.predicates.prompt import action_text, kind_lines, object_lines
from pix2pred.structs import Action, Image, Object, Picture, Skill, Type
from pix2pred.structs.views import View
from pix2pred.vlm import Answer, AnswerStore, Purpose, Request, StoredVLM, StoreMode, VLMError

FRUGAL = "labels: {protocol: frugal}\n"


def defines(request: Request) -> str:
    return "* lit(l1) | CHANGES | true when the lamp is bright | also: on | opposite: dark"


def histories(request: Request) -> str:
    """Every lamp is dark in the first of the states and never again."""
    atoms = request.text.rpartition("\nPredicates:\n")[2].splitlines()
    return "\n".join(f"* {atom}: False; 1 True" for atom in atoms if atom)


def frugal(request: Request) -> str:
    return defines(request) if request.purpose == Purpose.DEFINE else histories(request)


def renamed(project: Path, **names: str) -> None:
    file = project / "domain.yaml"
    text = file.read_text()
    for old, new in names.items():
        text = re.sub(rf"\b{old}\b", new, text)
    file.write_text(text)


@pytest.mark.parametrize("config", ["", FRUGAL])
@pytest.mark.parametrize("new", ["bulb", "aardvark", "zebra", "state", "l1", "l2", "robby"])
def test_a_run_whose_type_was_renamed_asks_nothing(cli: Cli, tmp_path: Path, config: str, new: str) -> None:
    project, settings = write_lamps(tmp_path / "p"), tmp_path / "s.yaml"
    settings.write_text(config)
    model = Fake(sees, frugal if config else sees)
    cli.registry = OneModel(model)
    told = ("learn", project, "--vlm", "any", "--config", settings, "--answers", tmp_path / "a")
    assert cli(*told, "--out", tmp_path / "old").code == 0
    asked = len(model.asked)
    assert asked
    renamed(project, lamp=new, robot="arm")
    planned = cli(*told, "--out", tmp_path / "new", "--dry-run", "--json").json
    assert planned["queries"] == planned["from_store"] > 0
    ran = cli(*told, "--out", tmp_path / "new")
    assert ran.code == 0, ran.err
    assert len(model.asked) == asked
    texts = ((tmp_path / run / "labels/traces.json").read_text() for run in ("old", "new"))
    labels = [re.sub(rf'"{new}"', '"lamp"', text).replace('"arm"', '"robot"') for text in texts]
    assert labels[0] == labels[1]
    assert cli(*told, "--out", tmp_path / "again", "--mode", "replay").code == 0
    assert cli("answers", "verify", tmp_path / "a").code == 0


def test_live_asks_all_the_same(cli: Cli, tmp_path: Path) -> None:
    project, model = write_lamps(tmp_path / "p"), Fake()
    cli.registry = OneModel(model)
    told = ("learn", project, "--vlm", "any", "--answers", tmp_path / "a")
    assert cli(*told, "--out", tmp_path / "old").code == 0
    asked = len(model.asked)
    renamed(project, lamp="bulb")
    assert cli(*told, "--out", tmp_path / "new", "--mode", "live").code == 0
    assert len(model.asked) == 2 * asked


ITEM = Type("item", description="What can be carried.")
ROBOT, CUP, PLATE = Type("robot"), Type("cup", parent=ITEM), Type("plate", parent=ITEM)
TAKE = Skill("Take", (ROBOT, ITEM))


def question(*kinds: Type, take: Skill = TAKE, sample: int = 0) -> Request:
    """A question about a robot called like its type, a mug, and a red cup."""
    objects = [Object(n, t) for n, t in zip(("robot", "mug", "red_cup"), kinds, strict=True)]
    text = "\n".join(
        ["Objects:", object_lines(objects), kind_lines(objects), skill_lines([take]), "A thing, a cup, an item.",
         action_text(Action(take, (objects[0], objects[1]))), "\nPredicates:", "cup(mug)", "near(robot, red_cup)"]
    )  # fmt: skip
    picture = Picture("main", Image.from_pixels(GREY))
    return Request(Purpose.LABEL, (text, View(picture, 0)), 100, sample=sample)


GREY = np.full((4, 4, 3), 9, "uint8")
THING = Type("thing", description=ITEM.description)
RENAMED = [
    question(ROBOT, Type("mug", parent=ITEM), PLATE),
    question(ROBOT, Type("zz", parent=ITEM), Type("aa", parent=ITEM)),
    question(ROBOT, Type("cup", parent=THING), Type("plate", parent=THING), take=Skill("Take", (ROBOT, THING))),
    question(ROBOT, PLATE, CUP),
]


@pytest.mark.parametrize("n", range(len(RENAMED)))
def test_names_of_types_are_no_part_of_what_is_asked(tmp_path: Path, n: int) -> None:
    store = AnswerStore(tmp_path)
    store.put(question(ROBOT, CUP, PLATE), "m", Answer("yes"))
    assert replay(store, RENAMED[n]) == "yes"


def replay(store: AnswerStore, request: Request) -> str | None:
    try:
        return StoredVLM(Fake(name="m"), store, StoreMode.REPLAY).answer(request).text
    except VLMError:
        return None


OTHERS = {
    "types that were two are one": question(ROBOT, CUP, CUP),
    "another sample": question(ROBOT, Type("mug", parent=ITEM), PLATE, sample=1),
    "another skill": question(ROBOT, Type("mug", parent=ITEM), PLATE, take=Skill("Grasp", (ROBOT, ITEM))),
    "no common parent": question(ROBOT, Type("mug", parent=ITEM), Type("plate")),
    "other words": replace(RENAMED[0], parts=(f"{RENAMED[0].text} Look well.", *RENAMED[0].views)),
}


@pytest.mark.parametrize("what", OTHERS)
def test_another_question_is_another_question(tmp_path: Path, what: str) -> None:
    store = AnswerStore(tmp_path)
    store.put(question(ROBOT, CUP, PLATE), "m", Answer("yes"))
    assert replay(store, RENAMED[0]) == "yes"
    assert replay(store, OTHERS[what]) is None
