"""Atoms in free text: the cases of method 2.2 and 14.3, and hostile answers."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pix2pred.predicates.proposing.parse_atoms import clean, mentions


def found(text: str) -> list[str]:
    return [str(m) for m in mentions(clean(text))]


CASES = {
    "bold in a list": ("* **On(patty1, grill)**", ["On(patty1, grill)"]),
    "prefix": ("Before: raw(patty1)", ["raw(patty1)"]),
    "LaTeX": (r"1. on\_table(patty1)", ["on_table(patty1)"]),
    "LaTeX brackets": (r"\(on\_table\(patty\_1\)\)", ["on_table(patty_1)"]),
    "several in a line": ("Synonyms: a(x), b(x)", ["a(x)", "b(x)"]),
    "no arguments": ("p()", []),
    "blank arguments": ("p(  ) q(,) r(a,) s(,a)", []),
    "no space": ("near(robot,grill)", ["near(robot, grill)"]),
    "variables": ("on(x, y): atop(x, y)", ["on(x, y)", "atop(x, y)"]),
    "line break": ("on(patty1,\n   grill)", ["on(patty1, grill)"]),
    "windows line break": ("on(\r\n\tpatty1\r\n)", ["on(patty1)"]),
    "space before the bracket": ("on (patty1)", ["on(patty1)"]),
    "line break before the bracket": ("see on\n(patty1)", []),
    "backticks": ("`on(patty1)`", ["on(patty1)"]),
    "hyphens": ("on-top(blue-cup)", ["on_top(blue_cup)"]),
    "inner spaces": ("on( small   blue cup ,grill)", ["on(small_blue_cup, grill)"]),
    "case is kept": ("OnTop(Patty1)", ["OnTop(Patty1)"]),
    "negation": ("not on(a) / ¬on(b) !on(c)", ["on(a)", "on(b)", "on(c)"]),
    "prose": ("Cooked (see above) and so on (e.g., a).", ["Cooked(see_above)"]),
    "prose with signs": ("f(x=1) g(a/b) h(a.b) i('a') j(a:b)", []),
    "nested": ("not(on(a, b))", ["on(a, b)"]),
    "unbalanced": ("on(a, b on(c, d)) ((e(f", ["on(c, d)"]),
    "digits first": ("1on(a) _on(b) on1(c)", ["_on(b)", "on1(c)"]),
    "braces": ("{on(a)} [on(b)] <on(c)>", ["on(a)", "on(b)", "on(c)"]),
    "table": ("| on(a) | True |", ["on(a)"]),
    "code block": ("```\non(a)\n```", ["on(a)"]),
    "empty": ("", []),
}


@pytest.mark.parametrize("case", CASES)
def test_cases_of_the_specification(case: str) -> None:
    text, atoms = CASES[case]
    assert found(text) == atoms


@given(st.text(alphabet=st.sampled_from("ab_-1 (),\n\\*`.:"), max_size=60) | st.text(max_size=60))
def test_any_text_gives_clean_names_only(text: str) -> None:
    for mention in mentions(clean(text)):
        assert mention.args
        assert all(re.fullmatch(r"\w+", name, re.ASCII) for name in (mention.name, *mention.args))


WORD = st.from_regex(r"[a-z_][a-z0-9_]{0,5}", fullmatch=True)


@given(st.lists(st.tuples(WORD, st.lists(WORD, min_size=1, max_size=3)), max_size=5), st.data())
def test_atoms_are_found_whatever_is_around_them(atoms: list[tuple[str, list[str]]], data: st.DataObject) -> None:
    around = st.sampled_from([" ", "\n* ", ", ", "**", "`", "1. ", ": ", " - ", "{", "}"])
    comma = st.sampled_from([",", ", ", " , ", ",\n "])
    text = "".join(
        f"{data.draw(around)}{name}({data.draw(comma).join(args)}){data.draw(around)}" for name, args in atoms
    )
    assert found(text) == [f"{name}({', '.join(args)})" for name, args in atoms]


LONG = 200_000
HOSTILE = [
    "(",
    ")",
    "a",
    "a(",
    "a (",
    " ",
    "\n",
    "a b ",
    "a,",
    "a(a,",
    "a(,",
    "-",
    "_",
    "\\",
    "\\_",
    "*",
    "a()",
    "1",
    "é(",
]


@pytest.mark.parametrize("unit", HOSTILE)
@pytest.mark.parametrize("start", ["", "a(", "a"])
def test_long_texts_are_read_in_linear_time(start: str, unit: str) -> None:
    assert len(found(start + unit * (LONG // len(unit)))) <= 1


def test_many_atoms_are_all_found() -> None:
    assert len(found("on(a, b)\n" * (LONG // 9))) == LONG // 9
