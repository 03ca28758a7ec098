"""Truth values in answers: the cases of method 3.6 and 14.3, and hostile answers."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pix2pred.predicates.labelling.parse_labels import parse_labels, value_lines
from pix2pred.structs import Label

QUERY = ("cooked(patty1)", "on(a, b)")
C, ON = QUERY


CASES: dict[str, tuple[str, dict[str, int]]] = {
    "explained": ("cooked(patty1): True. because it is brown", {C: Label.TRUE}),
    "lower case value": ("cooked(patty1): true.", {C: Label.TRUE}),
    "upper case value": ("cooked(patty1): FALSE.", {C: Label.FALSE}),
    "bold value": ("* cooked(patty1): **True**. Brown.", {C: Label.TRUE}),
    "bold line": ("* **cooked(patty1): True.** Brown.", {C: Label.TRUE}),
    "bold atom": ("- **cooked(patty1)**: False", {C: Label.FALSE}),
    "code": ("`cooked(patty1)`: `True`", {C: Label.TRUE}),
    "unknown": ("cooked(patty1): Unknown. Hidden.", {C: Label.UNKNOWN}),
    "maybe": ("cooked(patty1): Maybe.", {}),
    "maybe does not undo": ("cooked(patty1): True.\ncooked(patty1): Maybe.", {C: Label.TRUE}),
    "missing period": ("cooked(patty1): True", {C: Label.TRUE}),
    "missing atom": ("on(a, b): True.", {ON: Label.TRUE}),
    "extra atom": ("raw(patty1): True.\ncooked(patty1): False.", {C: Label.FALSE}),
    "wrong arity": ("on(a): True. on(a, b, c): True.", {}),
    "missing space": ("on(a,b): True.", {ON: Label.TRUE}),
    "more spaces": ("on ( a ,  b ) :True.", {ON: Label.TRUE}),
    "line-broken arguments": ("on(a,\n b): True.", {ON: Label.TRUE}),
    "LaTeX": (r"\text{x} cooked\(patty1\): True\.", {C: Label.TRUE}),
    "equals sign": ("cooked(patty1) = True", {C: Label.TRUE}),
    "case of the atom": ("Cooked(Patty1): True.", {C: Label.TRUE}),
    "two in a line": ("cooked(patty1): True, on(a, b): False", {C: Label.TRUE, ON: Label.FALSE}),
    "last wins": ("cooked(patty1): True.\ncooked(patty1): False.", {C: Label.FALSE}),
    "unknown can win": ("cooked(patty1): True.\ncooked(patty1): Unknown.", {C: Label.UNKNOWN}),
    "braces": ("{cooked(patty1): True. {brown} } {on(a, b): False. }}}", {C: Label.TRUE, ON: Label.FALSE}),
    "value in a sentence only": ("cooked(patty1) is True. True: cooked(patty1)", {}),
    "longer word": ("cooked(patty1): Trueish.", {}),
    "refusal": ("I'm sorry, I can't help with that.", {}),
    "empty": ("", {}),
    "three sections": (
        "1. Expected: cooked(patty1): True\n2. Observed: on(a, b): True\n3. Values:\n* cooked(patty1): False.",
        {C: Label.FALSE},
    ),
    "Markdown sections": (
        "## 1. Expected\ncooked(patty1): True\n## 3. Values\n* cooked(patty1): False. on(a, b): True.",
        {C: Label.FALSE, ON: Label.TRUE},
    ),
    "bold sections": ("**1. E**\non(a, b): True\n**3. Values**\n* cooked(patty1): True.", {C: Label.TRUE}),
    "named sections": ("Section 1: on(a, b): True\nSection 3: Values\ncooked(patty1): True.", {C: Label.TRUE}),
    "empty third section": ("1. cooked(patty1): True\n3. Values: see above", {C: Label.TRUE}),
    "sections swapped": ("3. Values\ncooked(patty1): True.\n1. Expected", {C: Label.TRUE}),
    "figures are no headings": (
        "on(a, b): True. It is 3.5 m away. cooked(patty1): True.",
        {C: Label.TRUE, ON: Label.TRUE},
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_cases_of_the_specification(case: str) -> None:
    text, values = CASES[case]
    parsed = parse_labels(text, QUERY)
    assert parsed.values == values
    assert parsed.missing == tuple(a for a in QUERY if a not in values)


def test_what_cannot_be_used_is_counted() -> None:
    parsed = parse_labels("raw(x): True. on(a): False. cooked(patty1): Maybe. cooked(patty1): Perhaps.", QUERY)
    assert (parsed.unasked, parsed.other_words) == (2, 2)


def test_value_lines_are_read_back() -> None:
    values = {C: Label.UNKNOWN, ON: Label.TRUE}
    assert value_lines(values) == "cooked(patty1): Unknown\non(a, b): True"
    assert parse_labels(value_lines(values), QUERY).values == values


def test_a_numbered_list_is_read_whole() -> None:
    lines = [f"{i}. p{i}(x): True." for i in range(1, 6)]
    assert len(parse_labels("\n".join(lines), [f"p{i}(x)" for i in range(1, 6)]).values) == 5


def test_the_value_before_the_skill_in_an_explanation_does_not_count() -> None:
    answer = "* cooked(patty1): True. The value before was cooked(patty1): False, now it is brown."
    assert parse_labels(answer, QUERY).values == {C: Label.TRUE}


def test_atoms_that_differ_in_case_are_two() -> None:
    parsed = parse_labels("Hot(x): True.\nhot(x): False.", ["Hot(x)", "hot(x)"])
    assert parsed.values == {"Hot(x)": Label.TRUE, "hot(x)": Label.FALSE}


TOKENS = (
    *("cooked", "(", "patty1", ")", "on", "a", ",", "b", ":", "=", " ", "\n", "True", "false", "Unknown", "Maybe"),
    *("3.", "1.", "Section 3:", "**", "`", "\\", "\\_", "{", "}", "-", ".", "#", "cooked(patty1): True."),
)


@given(st.lists(st.sampled_from(TOKENS), max_size=40).map("".join) | st.text(max_size=80))
def test_nothing_outside_the_query_is_labelled(text: str) -> None:
    parsed = parse_labels(text, QUERY)
    assert set(parsed.values) | set(parsed.missing) == set(QUERY)
    assert not set(parsed.values) & set(parsed.missing)
    assert set(parsed.values.values()) <= {Label.TRUE, Label.FALSE, Label.UNKNOWN}


@given(
    st.dictionaries(
        st.sampled_from([f"p{i}(x, y{i})" for i in range(9)]), st.sampled_from([Label.TRUE, Label.FALSE, Label.UNKNOWN])
    ),
    st.text(alphabet="abc. {}\n", max_size=20),
    st.data(),
)
def test_mutated_answers_give_right_values_or_none(values: dict[str, Label], noise: str, data: st.DataObject) -> None:
    lines = [f"* {line}. {noise}" for line in value_lines(values).splitlines()]
    text = "\n".join(data.draw(st.permutations(lines)))
    assert parse_labels(text, list(values)).values == values
    kept = text[: data.draw(st.integers(0, len(text)))]
    assert parse_labels(kept, list(values)).values.items() <= values.items()


LONG = 200_000


@pytest.mark.parametrize(
    "unit", ["(", "a", "a(", " ", "a(a): ", "on(a, b): x ", "on(a, b):", "- ", "#", "section ", "\n"]
)
def test_long_answers_are_read_in_linear_time(unit: str) -> None:
    assert parse_labels(unit * (LONG // len(unit)), QUERY).values == {}


def test_many_headings_without_values_are_read() -> None:
    """Kept short: reading is quadratic in the number of third headings without a value after them."""
    assert parse_labels("3.\n" * 1000, QUERY).values == {}
