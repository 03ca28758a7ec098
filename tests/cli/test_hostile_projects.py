"""Projects that would cost an afternoon or money: what is wrong is said before anything is asked."""

from __future__ import annotations

from pathlib import Path

import pytest

from command_line import Cli
from demos.photo_files import photo

DOMAIN = """
format: pix2pred-domain
version: 1
name: lamps
types: [{{name: robot}}, {{name: lamp, features: [x]}}, {{name: switch, features: [y]}}]
objects:
  robby: {{type: robot}}
{objects}
skills:
- {{name: Press, types: [robot, lamp]{bounds}}}
predicates:
- {{name: Done, types: [{types}], source: {source}}}
"""
DEMO = """
format: pix2pred-demo
version: 1
objects: [{names}]
goal: ["Done({goal})"]
actions: ["Press(robby, l0){params}"]
states:
- {{given: [], features: {{{first}}}}}
- {{given: [{holds}], features: {{{last}}}}}
"""


def project(tmp_path: Path, lamps: int, places: int, *, continuous: bool, first: str = "", last: str = "") -> Path:
    """A demonstration with one Press of the first of ``lamps``, and a goal over ``places`` of them."""
    names = [f"l{i}" for i in range(lamps)]
    goal = ", ".join(names[:places])
    folder = tmp_path / "p" / "demos" / "one"
    folder.mkdir(parents=True)
    objects = "\n".join(f"  {n}: {{type: lamp}}" for n in names)
    source = "human" if continuous else "vlm"
    bounds = ", low: [0], high: [1]" if continuous else ""
    types = ", ".join(["lamp"] * places)
    domain = DOMAIN.format(objects=objects, bounds=bounds, types=types, source=source)
    (tmp_path / "p" / "domain.yaml").write_text(domain)
    holds = f'"Done({goal})"' if continuous else ""
    text = DEMO.format(
        names=", ".join(["robby", *names]), goal=goal, params="[0.5]" if continuous else "", first=first, last=last,
        holds=holds,
    )  # fmt: skip
    (folder / "demo.yaml").write_text(text)
    for t in range(2):
        photo(folder / "images" / str(t) / "main.jpg", seed=t)
    return tmp_path / "p"


@pytest.mark.parametrize(
    ("lamps", "places", "count"), [(1000, 2, "999,000"), (20, 6, "27,907,200"), (60, 3, "205,320")]
)
def test_atoms_without_number_are_named_by_check_and_dry_run(
    cli: Cli, tmp_path: Path, lamps: int, places: int, count: str
) -> None:
    made = project(tmp_path, lamps, places, continuous=False)
    checked = cli("check", made)
    assert f"has {count} of " in checked.out and f"over {lamps + 1} objects" in checked.out
    ran = cli("learn", made, "--vlm", "openai:gpt-4o", "--out", tmp_path / "run", "--dry-run")
    assert ran.code == 2 and "flow.max_atoms" in ran.err


@pytest.mark.parametrize(
    ("first", "last", "wrong"),
    [
        ("l0: [0], l1: [0]", "l0: [0], l1: [0]", False),  # a robot has no features, and none are missed
        ("", "", True),
        ("l1: [0]", "l0: [0], l1: [0]", True),
        ("l0: [0], l1: [0]", "", True),
    ],
)
def test_features_that_parameters_are_learned_from_are_missed_in_time(
    cli: Cli, tmp_path: Path, first: str, last: str, wrong: bool
) -> None:
    ran = cli("check", project(tmp_path, 2, 1, continuous=True, first=first, last=last), "--no-cost")
    assert ran.code == (2 if wrong else 0), ran.out
    said = ("the features of l0 are missing", "features are missing for l0", "features must be given in every state")
    assert any(message in ran.out for message in said) == wrong
