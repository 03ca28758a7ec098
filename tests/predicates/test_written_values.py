"""Ways of writing a value: those that a person would read, and those that decide nothing."""

from __future__ import annotations

import json

import pytest

from pix2pred.predicates.labelling.parse_labels import parse_labels
from pix2pred.predicates.labelling.structured import as_text
from pix2pred.structs import Label

ATOM = "lit(a)"
TRUE, FALSE, UNKNOWN = Label.TRUE, Label.FALSE, Label.UNKNOWN

READ = {
    "* lit(a): False -> True": TRUE,
    "* lit(a): False → True (changed)": TRUE,
    "* lit(a): True => False": FALSE,
    "* lit(a): Unknown -> False -> True": TRUE,
    "* lit(a): True. It was False before.": TRUE,
    "* lit(a): True, was False": TRUE,
    "* lit(a): False. No longer bright (was True).": FALSE,
    "* lit(a): True, no longer dark": TRUE,
    "lit(a): False\n* lit(a): True": TRUE,
    "ｌｉｔ（ａ）： Ｔｒｕｅ": TRUE,
    "lit(a)：真": TRUE,
    "lit(a): 假。": FALSE,
    "lit(a): verdadero": TRUE,
    "* lit(a) — sí": TRUE,
    "lit(a): falso": FALSE,
    "lit(a): desconocido": UNKNOWN,
    "lit(a): Yes": TRUE,
    "lit(a): No.": FALSE,
    "lit(a): 1": TRUE,
    "lit(a): 0, as before": FALSE,
    "lit(a): ✓": TRUE,
    "lit(a) ✗": None,
    "lit(a): ✗": FALSE,
    "lit(a) is true": TRUE,
    "lit(a) is still false": FALSE,
    "lit(a) == True": TRUE,
    "lit(a) = False": FALSE,
    'lit("a"): True': TRUE,
    "lit('a'): False": FALSE,
    "lit(a):\n  True": TRUE,
    "**lit(a)**\n- False": FALSE,
    "| lit(a) | True | because |": TRUE,
    "| lit(a) | True | True |": TRUE,
}
"""``None`` where even a person would ask."""

UNDECIDED = (
    "* lit(a): True or False? True.",
    "* lit(a): True/False: it is hard to say",
    "* lit(a): True or False",
    "* lit(a): True? Yes.",
    "* lit(a): False (changed to True)",
    "* lit(a): False, now True",
    "| lit(a) | False | True | it was off |",
    "lit(a): No change. True",
    "lit(a): not true",
    "lit(a): 10",
    "lit(a): 1.5",
    "lit(a): False\n\nAfter that, lit(a): True.",
    "lit(a): True\nlit(a): True or False",
)


@pytest.mark.parametrize("answer", READ)
def test_what_a_person_would_read_is_read(answer: str) -> None:
    assert parse_labels(answer, [ATOM]).values.get(ATOM) == READ[answer]


@pytest.mark.parametrize("answer", UNDECIDED)
def test_what_decides_nothing_gives_no_value_and_is_asked_again(answer: str) -> None:
    parsed = parse_labels(answer, [ATOM])
    assert parsed.values == {} and parsed.missing == (ATOM,)


@pytest.mark.parametrize("answer", [a for a, value in READ.items() if value is not None])
def test_the_place_of_the_word_is_in_the_answer_as_given(answer: str) -> None:
    parsed = parse_labels(answer, [ATOM])
    assert parsed.places[ATOM] < len(answer) and not answer[parsed.places[ATOM]].isspace()


FORMS = {
    "arrow": "* {a}: {other} ⟶ {v}",
    "thick arrow": "* {a}: {other} ➜ {v}",
    "dashes": "* {a}: {other} --> {v}",
    "words": "* {a}: changed from {other} to {v}",
    "to": "* {a}: {other} to {v}",
    "was, now": "* {a}: was {other}, now {v}",
    "previously": "* {a}: previously {other}; currently {v}",
    "expected": "* {a}: expected {other}, observed {v}",
    "before in brackets": "* {a}: {v} (previously {other})",
    "question": "* {a}? {v}",
    "odd spaces": "*\u00a0{a}:\u2009\u200b{v}",
    "right to left": "\u200f* {a}: \u202b{v}\u202c",
    "objects": '{{"atom": "{a}", "value": "{v}"}}',
    "objects with truth": '{{ "predicate": "{a}", "truth_value": {v} }}',
    "explained by its opposite": "* {a}: {v}. It would be {other} if it moved.",
    "weighed": "* {a}: {v}, and not {other}",
    "explained by what was": "* {a}: {v}, no longer as it was",
    "explained by a denial": "* {a}: {v}. No, nothing moved; that {other} was said before is old.",
}
"""Both values in a line, of which one is right."""

NO_VALUE = {
    "before, after": "* {a}: {other} (before), {v} (after)",
    "no longer": "* {a}: {other} no longer; {v}",
    "waiting": "* {a}: {other}... wait, {v}",
    "actually": "* {a}: {other}. Actually, {v}.",
    "corrected": "* {a}: {other} – no, {v}",
    "on condition": "* {a}: {other} if the lid were open, else {v}",
    "with a choice": "* {a} (True/False): {v}",
    "struck out": "* {a}: ~~{other}~~ {v}",
    "hesitating": "* {a}: {other}? No: {v}",
}

TWO = {"lit(a)": TRUE, "lit(b)": FALSE}


def written(form: str) -> str:
    """Both lamps in ``form``."""
    other = {TRUE: "False", FALSE: "True"}
    return "\n".join(form.format(a=a, v=other[FALSE if v == TRUE else TRUE], other=other[v]) for a, v in TWO.items())


@pytest.mark.parametrize("form", FORMS)
def test_of_two_values_in_a_line_the_right_one_is_read(form: str) -> None:
    assert parse_labels(written(FORMS[form]), list(TWO)).values == TWO


@pytest.mark.parametrize("form", NO_VALUE)
def test_a_value_that_is_taken_back_is_none(form: str) -> None:
    assert parse_labels(written(NO_VALUE[form]), list(TWO)).values == {}


@pytest.mark.parametrize("words", [
    ("wahr", "falsch"), ("Vrai", "Faux"), ("Ja", "Nein"), ("да", "нет"), ("はい", "いいえ"), ("T", "F"), ("Y", "N"),
    ("Vero", "Falso"), ("Verdadeiro", "Falso"),
])  # fmt: skip
def test_words_of_other_languages_are_read_alone_and_not_within_a_sentence(words: tuple[str, str]) -> None:
    text = f"* lit(a): {words[0]}\n* lit(b): {words[1]}."
    assert parse_labels(text, list(TWO)).values == TWO
    assert parse_labels(f"lit(a): {words[0]} change", [ATOM]).values == {}


@pytest.mark.parametrize("denial", ["not ", "NOT ", "¬", "¬ ", "!", "~"])
def test_a_denied_atom_is_never_taken_for_the_atom(denial: str) -> None:
    assert parse_labels(f"* {denial}lit(a): True", [ATOM]).values == {ATOM: FALSE}
    assert parse_labels(f"* {denial}lit(a): False", [ATOM]).values == {}, "false that it is not, or simply false?"
    assert parse_labels("Look! lit(a): True", [ATOM]).values == {ATOM: TRUE}


ROWS = [{"atom": "lit(a)", "value": "True"}, {"atom": "lit(b)", "value": "False", "explanation": "dark"}]
SHAPES = {
    "as asked": json.dumps({"expected_changes": "e", "observed_changes": "o", "values": ROWS}),
    "fenced": f"```json\n{json.dumps({'values': ROWS})}\n```",
    "in prose": f"Here you are: {json.dumps({'values': ROWS})} I hope this helps.",
    "a list": json.dumps(ROWS),
    "a list in prose": f"The values:\n{json.dumps(ROWS)}\n",
    "atoms to words": json.dumps({"lit(a)": "True", "lit(b)": "False"}),
    "atoms to truth": json.dumps({"values": {"lit(a)": True, "lit(b)": False}}),
    "other keys": json.dumps({"labels": [{"predicate": r["atom"], "label": r["value"]} for r in ROWS]}),
    "atoms to objects": json.dumps({"lit(a)": {"value": True, "why": "x"}, "lit(b)": {"value": False}}),
    "nested": json.dumps({"result": {"state": {"values": ROWS}}}),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_json_is_read_in_whatever_form_it_comes(shape: str) -> None:
    parsed = parse_labels(as_text(SHAPES[shape]), ["lit(a)", "lit(b)"])
    assert parsed.values == {"lit(a)": TRUE, "lit(b)": FALSE}


@pytest.mark.parametrize("answer", ["lit(a): True", "", "{", "[" * 100_000, '{"values": 3}', "lit(a): True {no json}"])
def test_what_is_no_json_with_values_stays_as_it_is(answer: str) -> None:
    assert as_text(answer) == answer
