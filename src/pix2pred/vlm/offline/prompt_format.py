"""Reading our own prompts and writing answers in their format: what the reader and the oracle share."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from pix2pred.structs.views import View

_OBJECT_LINE = re.compile(r"^- (\S+) \(([^()\s]+)\)$", re.MULTILINE)
_ATOM_LINE = re.compile(r"^([A-Za-z_]\w*)\(([^()]*)\)$")
_ALL_OTHERS_FALSE = "All other predicates below: False"
_PREVIOUS = re.compile(r"<previous>\n(.*?)\n</previous>", re.DOTALL)
_VALUE_LINE = re.compile(r"^[* ]*([A-Za-z_]\w*\([^()]*\)): (True|False|Unknown)\b", re.MULTILINE)
_HISTORY_LINE = re.compile(
    r"^\* ([A-Za-z_]\w*\([^()]*\)): (True|False|Unknown)((?:; \d+ (?:True|False|Unknown))*)$", re.MULTILINE
)
_CHANGE = re.compile(r"; (\d+) (True|False|Unknown)")
_DEFINED = re.compile(r"<defined>\n(.*?)\n</defined>", re.DOTALL)
_DEFINED_LINE = re.compile(r"^- ([A-Za-z_]\w*)(\([^|\n]*\)) \|", re.MULTILINE)
_SKILL_LINE = re.compile(r"^(?:Executed skill:|\d+\.) (\w+)\[([^\[\]]*)\]$", re.MULTILINE)
_NAMES = {True: "True", False: "False", None: "Unknown"}


@dataclass(frozen=True, slots=True)
class AskedAtom:
    """An atom listed in a labelling prompt."""

    word: str
    names: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.word}({', '.join(self.names)})"


@dataclass(frozen=True, slots=True)
class KnownWord:
    """A word that a model can propose for arguments of ``types``.

    Words of one ``group`` mean the same, or the opposite where ``negated`` differs.
    """

    word: str
    types: tuple[str, ...]
    group: str
    negated: bool


def object_types(text: str) -> dict[str, str]:
    """The prompt's objects and their types."""
    return dict(_OBJECT_LINE.findall(text))


def executed_skills(text: str) -> list[tuple[str, tuple[str, ...]]]:
    """The skills between the states that a prompt shows, in their order, each with the names of its objects."""
    return [
        (skill, tuple(part.partition(":")[0].strip() for part in objects.split(",") if part.strip()))
        for skill, objects in _SKILL_LINE.findall(text)
    ]


def asked_atoms(text: str) -> Iterator[AskedAtom]:
    """The atoms to label, in the order of the prompt."""
    for line in text.rpartition("\nPredicates:\n")[2].splitlines():
        if match := _ATOM_LINE.match(line.strip()):
            yield AskedAtom(match[1], tuple(n.strip() for n in match[2].split(",")))


def previous_values(text: str) -> dict[str, str]:
    """The values of the state before, as words, where the prompt tells them."""
    match = _PREVIOUS.search(text)
    if not match:
        return {}
    others = dict.fromkeys((str(a) for a in asked_atoms(text)), "False") if _ALL_OTHERS_FALSE in match[1] else {}
    return others | dict(_VALUE_LINE.findall(match[1]))


def stated_values(text: str) -> dict[str, str]:
    """The values of the answer that a prompt quotes, as words; empty where it quotes none."""
    quoted = text.rpartition("<answer>\n")[2].partition("\n</answer>")[0] if "<answer>\n" in text else ""
    return dict(_VALUE_LINE.findall(quoted))


def current_views(views: Sequence[View]) -> list[View]:
    """The uncropped pictures of the latest state."""
    whole = [v for v in views if v.crop is None]
    latest = max((v.state for v in whole), default=0)
    return [v for v in whole if v.state == latest]


def states_shown(views: Sequence[View]) -> dict[int, list[View]]:
    """The uncropped pictures of every state, by its number in ascending order."""
    shown: dict[int, list[View]] = {}
    for view in sorted((v for v in views if v.crop is None), key=lambda v: v.state):
        shown.setdefault(view.state, []).append(view)
    return shown


def history_line(atom: AskedAtom | str, values: Mapping[int, bool | None]) -> str:
    """One bulleted line with the values by state: the first, then every one that differs from the one before."""
    said, before = [], None
    for i, (state, value) in enumerate(values.items()):
        if i == 0:
            said.append(_NAMES[value])
        elif value != before:
            said.append(f"{state} {_NAMES[value]}")
        before = value
    return f"* {atom}: {'; '.join(said)}"


def histories(answer: str, states: Sequence[int]) -> Iterator[tuple[str, dict[int, bool | None]]]:
    """The atoms of such lines and their values in each of ``states``."""
    words = {name: value for value, name in _NAMES.items()}
    for atom, first, rest in _HISTORY_LINE.findall(answer):
        changes = {int(number): words[word] for number, word in _CHANGE.findall(rest)}
        value, values = words[first], {}
        for state in states:
            value = values[state] = changes.get(state, value)
        yield atom, values


def value_line(atom: AskedAtom, value: bool | None, why: str) -> str:
    """One bulleted line of an answer."""
    return f"* {atom}: {_NAMES[value]}. {why}"


def label_answer(text: str, lines: Sequence[str]) -> str:
    """The whole answer to the labelling prompt ``text``: three sections where it asks for them."""
    values = "\n".join(lines)
    if "<previous>" not in text:
        return values
    return (
        "1. Expected changes: not considered; values are read from the picture alone.\n"
        "2. Observed changes: see the values.\n"
        f"3. Values:\n{values}"
    )


def proposal_answer(text: str, words: Sequence[KnownWord]) -> str:
    """One line per group of words that applies to the prompt's objects, synonyms and antonyms below it."""
    types = object_types(text)
    lines = ["Predicates that describe the scene, with synonyms and antonyms."]
    groups: dict[tuple[str, tuple[str, ...]], list[KnownWord]] = {}
    for word in words:
        groups.setdefault((word.group, word.types), []).append(word)
    for (_, signature), members in groups.items():
        example = _example(types, signature)
        if example is None:
            continue
        args = ", ".join(example)
        first, *rest = members
        lines.append(f"* {first.word}({args})")
        for title, negated in (("Synonyms", first.negated), ("Antonyms", not first.negated)):
            related = [f"{w.word}({args})" for w in rest if w.negated == negated]
            if related:
                lines.append(f"  {title}: {', '.join(related)}")
    return "\n".join([*lines, "In general: on(x, y) means that x rests on y."])


def defined_words(text: str) -> set[tuple[str, tuple[str, ...]]]:
    """The words that a prompt says are defined already, with their types."""
    match = _DEFINED.search(text)
    return {
        (word, tuple(t.strip() for t in types.split(",")))
        for word, signatures in (_DEFINED_LINE.findall(match[1]) if match else ())
        for types in re.findall(r"\(([^()]*)\)", signatures)
    }


def definition_answer(text: str, words: Sequence[KnownWord], meanings: Mapping[str, str] | None = None) -> str:
    """One line per group of words that is not defined yet, with ``meanings`` by group where they are known."""
    types, defined = object_types(text), defined_words(text)
    groups: dict[tuple[str, tuple[str, ...]], list[KnownWord]] = {}
    for word in words:
        groups.setdefault((word.group, word.types), []).append(word)
    lines = []
    for (group, signature), (first, *rest) in groups.items():
        example = _example(types, signature)
        if example is None or any((w.word, signature) in defined for w in (first, *rest)):
            continue
        meaning = (meanings or {}).get(group, f"What the word list means by {group}.")
        fields = [f"{first.word}({', '.join(example)})", "CHANGES", meaning]
        for title, negated in (("also", first.negated), ("opposite", not first.negated)):
            if related := [w.word for w in rest if w.negated == negated]:
                fields.append(f"{title}: {', '.join(related)}")
        lines.append("* " + " | ".join(fields))
    return "\n".join(lines)


def _example(types: Mapping[str, str], signature: Sequence[str]) -> list[str] | None:
    """The first distinct objects of the signature's types, or None when the scene lacks one."""
    chosen: list[str] = []
    for wanted in signature:
        fitting = [n for n, t in types.items() if t == wanted and n not in chosen]
        if not fitting:
            return None
        chosen.append(fitting[0])
    return chosen
