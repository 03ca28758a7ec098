"""Names that no file, terminal or planner can hold: said in ``check``, where they stand, and shortly."""

from __future__ import annotations

from pathlib import Path

import pytest

from cli.hostile import edit
from command_line import Cli

NEARLY_THE_SAME = {
    "type": ("- {name: plug}", "- {name: plug}\n- {name: Lamp}"),
    "type of several": ("- {name: plug}", "- {name: plug}\n- {name: PLUG}"),
    "object": ("  l2: {type: lamp}", "  l2: {type: lamp}\n  L2: {type: lamp}"),
    "skill": ("- {name: Press,", "- {name: press, types: [robot]}\n- {name: Press,"),
    "predicate": (
        "- {name: Done, types: [lamp], source: human}",
        "- {name: Done, types: [lamp], source: human}\n- {name: DONE, types: [lamp], source: human}",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", NEARLY_THE_SAME)
def test_names_that_differ_in_capitals_alone_are_refused(cli: Cli, data: Path, what: str) -> None:
    edit(data / "domain.yaml", *NEARLY_THE_SAME[what])
    ran = cli("check", data)
    assert ran.code == 2
    assert f"{what.split()[0]} '" in ran.out and "in capitals alone, and PDDL takes both for one" in ran.out


@pytest.mark.parametrize("old", ["Press", "Done", "plug"])
@pytest.mark.parametrize("half", [r"\ud800", r"a\uDFFFb", r"x \udbff"])
def test_half_a_character_is_called_so_with_its_line(cli: Cli, data: Path, old: str, half: str) -> None:
    text = (data / "domain.yaml").read_text()
    line = next(n for n, row in enumerate(text.splitlines(), start=1) if old in row)
    (data / "domain.yaml").write_text(text.replace(f"name: {old}", f'name: "{half}"'))
    ran = cli("check", data)
    assert ran.code == 2 and f"domain.yaml:{line}: " in ran.out and "halves of characters" in ran.out


@pytest.mark.parametrize("where", ["Press(robby, {})", "Press(robby, l1, {})", "{}(robby, l1)"])
def test_endless_names_do_not_come_back_whole(cli: Cli, data: Path, where: str) -> None:
    edit(data / "demos" / "d0" / "demo.yaml", "Press(robby, l1)", f'"{where.format("x" * 5000)}"')
    ran = cli("check", data)
    assert ran.code == 2 and "demo.yaml:6" in ran.out
    assert max(map(len, ran.out.split())) < 500 and "…" in ran.out


@pytest.mark.parametrize("kind", ["type", "skill", "predicate"])
def test_endless_names_that_are_declared_do_not_come_back_whole(cli: Cli, data: Path, kind: str) -> None:
    old = {"type": "plug", "skill": "Press", "predicate": "Done"}[kind]
    edit(data / "domain.yaml", f"name: {old}", f"name: {'x' * 5000}")
    ran = cli("check", data)
    assert ran.code == 2 and "domain.yaml:" in ran.out and "at most" in ran.out
    assert max(map(len, ran.out.split())) < 500
