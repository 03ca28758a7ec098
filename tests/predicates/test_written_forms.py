"""Answers in other forms than lines of words: what a person would read is read, what is doubtful is not."""

from __future__ import annotations

import pytest

from pix2pred.predicates.frugal.histories import HistoryFormat
from pix2pred.predicates.labelling.label_format import LabelFormat
from pix2pred.structs import Label

A, B, C = "On(a, b)", "lit(a)", "lit(b)"
WANTED = {A: Label.TRUE, B: Label.TRUE, C: Label.FALSE}
ROWS = [(atom, value.word.capitalize()) for atom, value in WANTED.items()]


def each(form: str, join: str = "\n") -> str:
    """The three atoms in ``form``, where ``{m}`` is a tick or nothing and ``{o}`` the order in which they are asked."""
    marks = {"True": "x", "False": " "}
    return join.join(form.format(a=a, v=v, m=marks[v], w=v.lower(), o=o) for o, (a, v) in enumerate(ROWS, 1))


READ = {
    "boxed": each(r"* {a}: \boxed{{{v}}}"),
    "boxed text": each(r"{a}: $\boxed{{\text{{{v}}}}}$"),
    "boxed line": each(r"\boxed{{{a}: {v}}}"),
    "aligned": r"\boxed{\begin{aligned} " + each(r"\text{{{a}}} &: \text{{{v}}}", r" \\ ") + r" \end{aligned}}",
    "tabular": r"\begin{tabular}{ll}" + each(r"{a} & {v} \\") + r"\end{tabular}",
    "bold LaTeX": each(r"\textbf{{{a}}}: \textbf{{{v}}}"),
    "HTML table": "<table><tr><th>atom</th><th>value</th></tr>" + each("<tr><td>{a}</td><td>{v}</td></tr>", ""),
    "HTML table over lines": "<table>\n" + each("<tr>\n <td class='x'>{a}</td>\n <td><b>{v}</b></td></tr>"),
    "HTML breaks": each("{a}: {v}", "<br/>"),
    "HTML items": "<ul>" + each("<li><code>{a}</code>: <b>{v}</b></li>", "") + "</ul>",
    "HTML definitions": "<dl>" + each("<dt>{a}</dt><dd>{v}</dd>", "") + "</dl>",
    "entities": each("{a}:&nbsp;{v}").replace(", ", ",&nbsp;"),
    "attributes": each('<atom name="{a}">{v}</atom>'),
    "boxes": each("- [{m}] {a}"),
    "numbered boxes": each("{o}. [{m}] {a}").replace("[x]", "[X]"),
    "boxes with reasons": f"- [x] {A} - it stands on it\n- [x] {B}, bright\n- [ ] {C}: it is not lit",
    "ballots": f"☑ {A}\n☑ {B}\n☐ {C}",
    "ticks": f"✅ {A}\n✅ {B}\n❌ {C}",
    "one ticked box": f"- [x] {A}\n- [x] {B}\n{C}: False\n".replace(f"{C}: False", f"- [ ] {C}"),
    "YAML": each("{a}: {w}"),
    "YAML rows": "```yaml\nvalues:\n" + each("  - atom: {a}\n    explanation: so\n    value: {w}") + "\n```",
    "CSV": "atom,value\n" + each('"{a}",{v}'),
    "CSV with reasons": "atom,value,why\n" + each('"{a}",{v},"as it, really, looks"'),
    "CSV, value first": "value,atom\n" + each('{v},"{a}"'),
    "semicolons": each("{a};{v}"),
    "TSV": "atom\tvalue\n" + each("{a}\t{v}"),
    "table, value last": "| atom | why | value |\n|---|---|---|\n" + each("| `{a}` | it looks so | **{v}** |"),
    "table, value first": "| value | atom |\n|---|---|\n" + each("| {v} | {a} |"),
    "table of before and after": f"| atom | Before | After |\n|---|---|---|\n| {A} | False | True |\n"
    f"| {B} | True | True |\n| {C} | True | False |",
    "JSON lines": each('{{"atom": "{a}", "explanation": "so", "value": {w}}}'),
    "JSON lines of atoms": each('{{"{a}": {w}}}'),
    "arguments apart": '[{"predicate": "On", "args": ["a", "b"], "value": true}, '
    '{"predicate": "lit", "args": ["a"], "value": true}, {"predicate": "lit", "args": ["b"], "value": false}]',
    "lists of atoms": f'{{"true": ["{A}", "{B}"], "false": ["{C}"], "unknown": []}}',
    "numbers": f'{{"{A}": 1, "{B}": 1, "{C}": 0}}',
    "comma at the end": "{" + each('"{a}": {w},', " ") + "}",
    "Python": "{" + each("'{a}': {v}", ", ") + "}",
    "before and after": f'{{"before": {{"{A}": false, "{C}": true}}, "after": {{' + each('"{a}": {w}', ", ") + "}}",
    "other order": f"1. {C}: False\n2. {B}: True\n3. {A}: True",
    "sections in sections": f"3. Values\n3.1. {C}: False\n3.2. {B}: True\n3.3. {A}: True",
    "under headings": f"True:\n- {A}\n- {B}\n\nFalse:\n- {C}",
    "behind headings": f"**True:** {A}, {B}\n**False:** {C}",
    "headings without colons": f"True\n{A}\n{B}\nFalse\n{C}",
    "value first": each("{v}: {a}"),
    "brackets": each("{a} ({v})"),
    "brackets after a colon": each("{a}: [{v}]"),
    "dots": each("{a} ........ {v}"),
    "columns": each("{a}      {v}"),
    "questions": each("{a}?\n{v}"),
    "below a reason": each("### {a}\nSo it looks.\n**Value:** {v}"),
    "reason first": each("* {a}: So it looks. {v}"),
    "tick and word": f"{A}: ✅ True\n{B}: ✔\ufe0f True\n{C}: ❌ False",
    "italic": each("_{a}_: _{v}_"),
    "colours": each("\x1b[1m{a}\x1b[0m: \x1b[32m{v}\x1b[0m"),
}


@pytest.mark.parametrize("structured", [False, True], ids=["words", "JSON asked"])
@pytest.mark.parametrize("form", READ)
def test_what_says_every_value_is_read(form: str, structured: bool) -> None:
    assert LabelFormat(structured).read(READ[form], list(WANTED)).values == WANTED


DOUBTFUL = {
    "a blank form": f"- [ ] {A}\n- [ ] {B}\n- [ ] {C}",
    "things done": f"- [x] looked at {A}\n- [ ] decide {C}",
    "a tick denied": f"- [x] {B}: it is not lit",
    "choices": f"| {A} | True/False |\n| {B} | True/False |",
    "models that differ": f"| atom | one | two |\n|---|---|---|\n| {A} | True | False |",
    "numbers of rows": f"| 1 | {A} | it stands |\n| 0 | {B} | dark |",
    "rows with numbers": f'id,atom,why\n1,"{A}",stands\n0,{B},bright',
    "the state before": f"| atom | before |\n|---|---|\n| {B} | True |",
    "what was expected": f"| atom | expected | seen |\n|---|---|---|\n| {B} | True | unclear |",
    "what was": f"{B} (True before)",
    "two in brackets": f"{B} [True, False]",
    "both headings": f"True: {B}\nFalse: {B}",
    "headings of something else": f"True before:\n- {B}\nFalse positives:\n- {C}",
    "an empty heading": "True:\nFalse:\nUnknown:",
    "prose under a heading": f"True:\nNothing that I see; {B} is hidden.",
    "rows that differ": f"- atom: {B}\n  value: true\n- atom: {B}\n  value: false",
    "JSON that differs": f'[{{"atom": "{B}", "value": true}}, {{"atom": "{B}", "value": false}}]',
    "probabilities": f'{{"{B}": 0.9, "{C}": 0.1}}',
    "nothing": f'{{"{B}": null, "{C}": "?"}}',
    "an explanation with both": f"* {B}: it was True before. False",
    "an explanation against it": f"* {B}: I do not see it lit. True",
    "no and true": f"{B}: No, True",
    "yes and false": f"{B}: Yes - False",
    "the beginning of a choice": f"{B}: True or",
    "nearly": f"{B}: true-ish",
    "struck out": f"{B}: <s>True</s> False",
    "a comment": f"<!-- {B}: True -->",
    "numbers in place of names": "1. True\n2. True\n3. False",
}


@pytest.mark.parametrize("structured", [False, True], ids=["words", "JSON asked"])
@pytest.mark.parametrize("form", DOUBTFUL)
def test_what_is_doubtful_is_asked_again(form: str, structured: bool) -> None:
    assert LabelFormat(structured).read(DOUBTFUL[form], list(WANTED)).values == {}


def test_an_answer_of_one_word_is_read_where_one_atom_is_asked() -> None:
    assert LabelFormat().read("**True.**", [A]).values == {A: Label.TRUE}
    assert LabelFormat().read("True.", [A, B]).values == {}


def test_histories_are_read_without_their_markup() -> None:
    answer = r"<li>lit(a): \boxed{True}; 2 False</li><li><b>lit(b)</b>: False</li>"
    assert HistoryFormat((1, 2)).read(answer, [B, C]).values == {
        B: (Label.TRUE, Label.FALSE),
        C: (Label.FALSE, Label.FALSE),
    }


@pytest.mark.parametrize(
    "piece", ["<tr><td>", "- [x] ", "| , ;\t", "True:\n", ". true", "<!-- ", r"\boxed{", "lit(a)\n"]
)
def test_long_answers_without_values_are_read_to_their_end(piece: str) -> None:
    assert LabelFormat().read(piece * (100_000 // len(piece)), [A]).values == {}
