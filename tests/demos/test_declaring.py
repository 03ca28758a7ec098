"""Domains declared in one line each, and the file that is written of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from pix2pred.demos import check_project
from pix2pred.demos.authoring.declaring import DeclarationError, declare
from pix2pred.demos.authoring.domain_text import domain_text
from pix2pred.demos.authoring.example import example_declarations
from pix2pred.demos.files.documents import DomainDoc, load_document

TYPES = ("item", "cup:item", "robot", "box:item[angle, x]")
OBJECTS = ('mug:cup = the "blue": mug # ü', "robby:robot")
SKILLS = ("Pick(robot, cup)", "Pour(cup)[0..90, -1..1]", "Wait()")
PREDICATES = (
    "Full(cup) = vlm: full_of_tea",
    "Hot(cup)=human",
    "Holding(robot, cup) = skills: +Pick(0, 1)",
    "Open(box) = features: (<= box.angle 0.5)",
)


@pytest.mark.parametrize(("initial", "skills"), [(PREDICATES, SKILLS), ((), ())])
def test_what_is_declared_is_read_back(tmp_path: Path, initial: tuple[str, ...], skills: tuple[str, ...]) -> None:
    declared = declare(TYPES, OBJECTS, skills, initial)
    (tmp_path / "domain.yaml").write_text(domain_text('tea: "x"\n', declared), encoding="utf-8")
    loaded = load_document(tmp_path / "domain.yaml", tmp_path, DomainDoc, [])
    assert loaded is not None
    doc = loaded[1]
    assert (doc.types, doc.objects, doc.skills, doc.predicates) == (
        declared.types, declared.objects, declared.skills, declared.predicates,
    )  # fmt: skip
    assert doc.objects["mug"].descriptor == 'the "blue": mug # ü'


def test_triggers_and_bounds() -> None:
    declared = declare(TYPES, (), SKILLS, ("Held(cup) = skills: +Pick(1) -Pour(0)",))
    predicate = declared.predicates[0]
    assert [(t.skill, t.args) for t in (*predicate.set_by, *predicate.cleared_by)] == [("Pick", (1,)), ("Pour", (0,))]
    assert (declared.skills[1].low, declared.skills[1].high) == ((0.0, -1.0), (90.0, 1.0))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"types": ["my cup"]}, "'my cup' is not a valid name"),
        ({"types": ["cup", "cup"]}, "'cup' is declared twice"),
        ({"types": ["a:b", "b:a"]}, "its own ancestor"),
        ({"types": ["cup"], "objects": ["mug"]}, "expected NAME:TYPE"),
        ({"types": ["cup"], "objects": ["mug:cpu"]}, "did you mean 'cup'?"),
        ({"types": ["cup"], "objects": ["a:cup", "a:cup"]}, "'a' is declared twice"),
        ({"types": ["cup"], "skills": ["Pick"]}, "expected Name\\(object"),
        ({"types": ["cup"], "skills": ["Pick(cap)"]}, "did you mean 'cup'?"),
        ({"types": ["cup"], "skills": ["Pick(cup)", "Pick(cup)"]}, "'Pick' is declared twice"),
        ({"types": ["cup"], "skills": ["Pour(cup)[a..1]"]}, "expected bounds"),
        ({"types": ["cup"], "skills": ["Pour(cup)[1..0]"]}, "low <= high"),
        ({"types": ["cup"], "predicates": ["On(cup)"]}, "where its values come from"),
        ({"types": ["cup"], "predicates": ["On(cup) = guess"]}, "Input should be"),
        ({"types": ["cup"], "predicates": ["On(cup) = domain"]}, "for simulators"),
        ({"types": ["cup"], "predicates": ["On(cup) = vlm: two words"]}, "one word"),
        ({"types": ["cup"], "predicates": ["On(cup) = skills"]}, "which skills"),
        ({"types": ["cup"], "predicates": ["On(cup) = skills: Pick(0)"]}, r"expected \+Skill"),
        ({"types": ["cup"], "predicates": ["On(cup) = skills: +Pick(x)"]}, "positions"),
        ({"types": ["cup"], "predicates": ["On(cup) = skills: +Pick(0)"]}, "'Pick' is not declared"),
        ({"types": ["cup"], "predicates": ["On(cup) = features: (<= cup.x"]}, "predicate On"),
        ({"types": ["cup"], "predicates": ["On(cup) = human: me"]}, "takes nothing more"),
    ],
)  # fmt: skip
def test_what_cannot_be_understood_is_said(given: dict[str, list[str]], message: str) -> None:
    with pytest.raises(DeclarationError, match=message.replace("?", r"\?")):
        declare(**given)


def test_all_that_is_wrong_is_said_at_once() -> None:
    with pytest.raises(DeclarationError) as caught:
        declare(["cup:", "tray"], ["a"], ["Pick"], ["On(tray)"])
    assert len(str(caught.value).splitlines()) == 4


def test_an_empty_domain_says_what_belongs_into_it(tmp_path: Path) -> None:
    (tmp_path / "domain.yaml").write_text(domain_text("x", declare()))
    lines = (tmp_path / "domain.yaml").read_text().splitlines()
    problems = [p for p in check_project(tmp_path) if p.line]
    assert [lines[p.line - 1] for p in problems if p.line] == ["types: []", "skills: []", "predicates: []"]
    assert all("to be filled in" in p.message for p in problems)


def test_the_example_is_sound() -> None:
    assert example_declarations().objects
