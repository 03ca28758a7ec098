"""Reading predicates that a model wrote as code."""

from __future__ import annotations

from pix2pred.approaches.parse_code import parse_code
from pix2pred.structs import Type

ITEM = Type("item")


def test_a_trailing_comma_and_spaces_before_the_bracket_are_accepted() -> None:
    for end in (")", ",)", " )", " ,\n )"):
        found, rejected = parse_code(f'```\nA = Predicate("A", [item], f{end}\n```', {"item": ITEM})
        assert [p.name for p in found] == ["A"] and not rejected


def test_a_flood_of_spaces_takes_no_longer_than_any_other_text() -> None:
    """With quadratic reading this would take an hour: ending at all is the test."""
    answer = '```\nA = Predicate("A", [item], f' + " \n" * 200_000 + "\n```"
    found, (block,) = parse_code(answer, {"item": ITEM})
    assert not found and block.reason.startswith("no predicate")


def test_what_only_looks_like_a_name_is_none() -> None:
    for name, function in (("Is\u2479ow", "f"), ("IsLow", "f\u2479")):  # a letter to expressions, not to Python
        found, (rejected,) = parse_code(f'```\nLow = Predicate("{name}", [item], {function})\n```', {"item": ITEM})
        assert not found and "no predicate is assigned" in rejected.reason
