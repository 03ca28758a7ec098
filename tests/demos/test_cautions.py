"""What is allowed and will hurt later."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from demos.photo_files import photo
from pix2pred.demos import inspect_project
from pix2pred.demos.authoring import declare, domain_text, write_drafts
from pix2pred.demos.importers import drafts_of_frames
from pix2pred.structs import Image

DOMAIN = """\
format: pix2pred-domain
version: 1
name: cups
types: [{name: cup}, {name: robot}]
objects:
  a: {type: cup}
  b: {type: cup}
  robby: {type: robot}
  lost: {type: cup}
skills:
- {name: Pick, types: [robot, cup]}
- {name: Put, types: [robot, cup]}
- {name: Drop, types: [robot]}
predicates:
- {name: Full, types: [cup], source: vlm}
- name: Held
  types: [cup]
  source: skills
  set_by: [{skill: Pick, args: [1]}]
"""
DEMO = """\
format: pix2pred-demo
version: 1
objects: [a, b, robby]
goal: ["Full(a)"]
actions: ["Pick(robby, a)", "Put(robby, a)", "Pick(robby, a)"]
states:
- {}
- {}
- {}
- {}
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    (tmp_path / "domain.yaml").write_text(DOMAIN)
    for name in ("one", "two"):
        for t in range(4):
            photo(tmp_path / f"demos/{name}/images/{t}/main.jpg", seed=t)
        (tmp_path / f"demos/{name}/demo.yaml").write_text(DEMO)
    (tmp_path / "demos/two/demo.yaml").write_text(
        DEMO.replace("a)", "b)").replace('"Put(robby, b)"', '"Pick(robby, b)"')
    )
    return tmp_path


def warnings(project: Path) -> list[tuple[str, int | None, str]]:
    found = inspect_project(project)
    assert found.problems == () and found.project is not None
    return [(w.file.name, w.line, w.message) for w in found.warnings]


def test_what_the_demonstrations_lack(project: Path) -> None:
    assert [(name, line, message.partition(":")[0]) for name, line, message in warnings(project)] == [
        ("domain.yaml", 9, "object lost is in no demonstration and no task"),
        ("domain.yaml", 12, "skill Put is seen once"),
        ("domain.yaml", 13, "skill Drop is in no demonstration"),
    ]


def test_a_single_demonstration_and_an_object_without_a_part(project: Path) -> None:
    (project / "demos/two").rename(project / "elsewhere")
    said = warnings(project)
    assert any(name == "demos" and "one demonstration" in message for name, _, message in said)
    assert ("demo.yaml", 3, "object b is never mentioned by an action or a goal, here or elsewhere") in said


def test_a_goal_that_holds_at_the_start(project: Path) -> None:
    file = project / "demos/one/demo.yaml"
    file.write_text(DEMO.replace("Full(a)", "Held(a)").replace("- {}", '- given: ["Held(a)"]', 1))
    assert ("demo.yaml", 4, "the goal already holds at the start: nothing is demonstrated") in warnings(project)


def test_pictures_that_are_alike_empty_or_tiny(project: Path) -> None:
    images = project / "demos/one/images"
    noisy = Image(images / "1/main.jpg").pixels().astype(int) + np.random.default_rng(0).integers(-4, 5, (120, 160, 3))
    (images / "1/main.jpg").rename(images / "1/main.png")
    (images / "1/main.png").write_bytes(Image.from_pixels(np.clip(noisy, 0, 255).astype(np.uint8)).encoded)
    (images / "2/main.jpg").write_bytes((project / "demos/two/images/1/main.jpg").read_bytes())
    (images / "3/main.jpg").unlink()
    (images / "3/main.png").write_bytes(Image.from_pixels(np.full((120, 160, 3), 90, np.uint8)).encoded)
    for t in range(4):
        photo(project / f"demos/two/images/{t}/main.jpg", seed=t, size=(64, 48))
    said = warnings(project)
    assert ("demo.yaml", 9, "the pictures look the same as in the state before: nothing can be seen to change") in said
    assert ("main.png", None, "shows one colour and nothing else") in said
    assert sum("64x48 pixels are too small" in message for _, _, message in said) == 1
    assert sum("look the same" in message for _, _, message in said) == 1


def test_a_small_change_is_seen(project: Path) -> None:
    pixels = Image(project / "demos/one/images/0/main.jpg").pixels().copy()
    pixels[50:56, 80:86] ^= 128
    (project / "demos/one/images/1/main.jpg").unlink()
    (project / "demos/one/images/1/main.png").write_bytes(Image.from_pixels(pixels).encoded)
    assert not any("look the same" in message for _, _, message in warnings(project))


def test_boxes_too_small_to_see_anything_in(project: Path) -> None:
    file = project / "demos/one/demo.yaml"
    file.write_text(DEMO.replace("- {}", "- pictures: {main: {a: [0, 0, 3, 30], b: [0, 0, 20, 30]}}", 1))
    assert any("box of 'a' is 3x30 pixels" in message and line == 7 for _, line, message in warnings(project))


def test_a_project_without_pictures(project: Path) -> None:
    import shutil

    shutil.rmtree(project / "demos/one/images")
    assert any(line == 6 and "images/0/main.jpg" in message for _, line, message in warnings(project))


def test_an_unknown_key_hides_nothing_else(project: Path) -> None:
    file = project / "demos/one/demo.yaml"
    file.write_text(DEMO.replace("goal:", "gaol: 1\ngoal:").replace("Pick(robby, a)", "Pick(roby, a)", 1))
    problems = inspect_project(project).problems
    assert [p.line for p in problems] == [4, 6], problems
    assert "did you mean 'goal'?" in problems[0].message and "did you mean 'robby'?" in problems[1].message


HUMAN = ["Hot(cup) = human", "Full(cup) = human"]


def test_labels_that_a_person_forgot_are_not_taken_for_false_without_a_word(tmp_path: Path) -> None:
    photo(tmp_path / "photos" / "0.jpg", seed=0)
    photo(tmp_path / "photos" / "1.jpg", seed=1)
    declared = declare(["cup"], ["mug:cup"], ["Heat(cup)"], HUMAN)
    write_drafts(tmp_path / "p", drafts_of_frames(tmp_path / "photos"), domain_text("p", declared))
    demo = tmp_path / "p" / "demos" / "photos" / "demo.yaml"
    messages = [p.message for p in inspect_project(tmp_path / "p").problems]
    assert sum("the atoms that hold here" in m and "[] says that none does" in m for m in messages) == 2
    text = demo.read_text().replace("goal:\n- TODO", "goal:\n- Hot(mug)").replace("- TODO", "- Heat(mug)")
    demo.write_text(text.replace("given: [TODO]", "given: []", 1).replace("[TODO]", '["Hot(mug)"]'))
    found = inspect_project(tmp_path / "p")
    assert found.problems == ()
    assert [p.message for p in found.warnings if "'given'" in p.message] == [
        "Full(cup) is listed under 'given' in no state: it is taken for false everywhere"
    ]


def test_where_a_person_lists_nothing_nothing_is_to_be_filled_in(tmp_path: Path) -> None:
    photo(tmp_path / "photos" / "0.jpg", seed=0)
    photo(tmp_path / "photos" / "1.jpg", seed=1)
    declared = declare(["cup"], ["mug:cup"], ["Heat(cup)"], ["Hot(cup) = vlm"])
    write_drafts(tmp_path / "p", drafts_of_frames(tmp_path / "photos"), domain_text("p", declared))
    assert (tmp_path / "p" / "demos" / "photos" / "demo.yaml").read_text().count("- given: []") == 2
