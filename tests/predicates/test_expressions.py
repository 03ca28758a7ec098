"""Feature expressions: values by hand, text form, hostile texts."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pix2pred.structs import Object, State, Type
from pix2pred.structs.expressions import (
    AtMost,
    Expression,
    ExpressionError,
    ForAll,
    Not,
    arguments,
    evaluate,
    parse_expression,
)

CUP, BOX = Type("cup", ("x", "z")), Type("box", ("z",))
A, B, C = Object("a", CUP), Object("b", CUP), Object("c", BOX)
STATE = State((), {A: (0.0, 1.0), B: (0.0, 2.0), C: (9.0,)})
LOW = AtMost("cup", "z", 1.0)


def test_values_by_hand() -> None:
    assert evaluate(LOW, STATE, (A,))
    assert not evaluate(LOW, STATE, (B,))
    assert evaluate(Not(LOW), STATE, (B,))
    assert not evaluate(ForAll(LOW), STATE, ())
    assert evaluate(Not(ForAll(LOW)), STATE, ())
    assert not evaluate(ForAll(Not(LOW)), STATE, ())
    assert evaluate(ForAll(AtMost("cup", "z", 2.0)), STATE, ()), "the box is not a cup"
    assert evaluate(AtMost("box", "z", 9.0), STATE, (C,))


def test_missing_features_are_errors() -> None:
    with pytest.raises(ExpressionError, match=r"a has no feature 'z' .*needed by \(<= cup\.z 1\.0\)"):
        evaluate(LOW, State(), (A,))
    with pytest.raises(ExpressionError, match="no feature 'y'"):
        evaluate(AtMost("cup", "y", 0.0), STATE, (A,))


def test_arguments() -> None:
    types = {"cup": CUP}
    assert arguments(Not(LOW), types) == (CUP,)
    assert arguments(Not(ForAll(LOW)), types) == ()
    with pytest.raises(ExpressionError, match=r"'box' of .* is not declared"):
        arguments(AtMost("box", "z", 0.0), types)


NAME = st.from_regex(r"[a-z][a-z0-9_\-]{0,6}", fullmatch=True)
LEAVES: st.SearchStrategy[Expression] = st.builds(AtMost, NAME, NAME, st.floats(allow_nan=False))


@given(LEAVES, st.lists(st.sampled_from([Not, ForAll]), max_size=10))
def test_text_parses_back(leaf: Expression, wrappers: list[type[Not] | type[ForAll]]) -> None:
    expression = leaf
    for wrap in wrappers:
        expression = wrap(expression)
    assert parse_expression(str(expression)) == expression
    assert parse_expression(f"  {expression}\n") == expression


HOSTILE = [
    "", "()", "(<= a.b)", "(<= a 1)", "(<= a.b x)", "(<= a.b 1e)", "(<= a.b nan)", "(<= a.b 1) (<= a.b 1)", "(not)",
    "(not (<= a.b 1)", "not (<= a.b 1)", "(exists (<= a.b 1))", "__import__('os').system('x')", "(<= a.b __import__)",
    "(<= a.b 1+1)", "(<= a..b 1)", "(not (not))", "(" * 100_000, "(not " * 100_000, "(<= a.b " + "9" * 100_000,
    "(not " * 5000 + "(<= a.b 1)" + ")" * 5000,
]  # fmt: skip


@pytest.mark.parametrize("text", HOSTILE, ids=lambda text: str(text[:20]))
def test_other_texts_are_expression_errors(text: str) -> None:
    with pytest.raises(ExpressionError) as caught:
        parse_expression(text)
    assert len(str(caught.value)) < 300


@given(st.text(alphabet="(<=notfrallab.19e- )", max_size=50))
def test_any_text_parses_or_is_an_expression_error(text: str) -> None:
    try:
        assert parse_expression(str(parse_expression(text)))
    except ExpressionError as error:
        assert str(error)
