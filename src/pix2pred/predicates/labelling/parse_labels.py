"""Reading truth values out of a model's answer (method 3.6)."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from pix2pred.predicates.proposing.parse_atoms import clean, kept, mentions
from pix2pred.structs import Label

_SYNONYMS: Mapping[Label, str] = {
    Label.TRUE: "yes y t 1 ✓ ✔ ✅ ☑ verdadero cierto sí si wahr ja richtig vrai oui vero verdadeiro 真 是 对 正确 はい "
    "참 да",
    Label.FALSE: "no n f 0 ✗ ✘ ❌ ✕ ✖ falso falsch nein faux non não 假 否 错 错误 偽 いいえ 거짓 нет ложь",
    Label.UNKNOWN: "desconocido unbekannt inconnu sconosciuto desconhecido 未知 不确定 不明",
}
"""Other words for the three values. They count only where nothing but punctuation follows: "No change" is no "No"."""
_WORDS: Mapping[str, Label] = {label.word: label for label in Label}
ALL_WORDS = dict(_WORDS) | {word: label for label, words in _SYNONYMS.items() for word in words.split()}
"""What every word for a value means, in small letters."""
_WORD = r"([^\W\d_]+|[01](?![\w.])|[✓✔✅☑✗✘❌✕✖])"
_SOMETHING = r"[\"'_ \t]*+"
_NAMED = r"(?:(?:the )?(?:truth )?(?:value|answer|label|verdict|A)(?: is|[ \t]*+[:：=]))?"
_CLOSED = rf"(?=[^\W_]+{_SOMETHING}[)\]}}>])"
_OPENED = rf"(?:{_SOMETHING}[(\[{{<]{_SOMETHING}{_CLOSED}|{_SOMETHING})"
"""What may stand between an atom that begins a line and its value: a name for values, and brackets."""
_VALUE = re.compile(rf"[ \t]*(?:[:：]|={{1,3}})[ \t]*{_WORD}")
_ALONE = r"(?=[ \t]*+\w++[ \t.]*+(?:\n|\Z))"
"""Before a word that ends its line."""
_LINE_VALUE = re.compile(
    rf"{_SOMETHING}(?:[:|：?→]|={{1,3}}>?|->|-|–|—|is(?: now| still)?\b{_ALONE}|[:：?]?[ \t]*+\n[ \t>+\-]*+{_ALONE}"
    rf"|[ \t.]*+{_ALONE}|(?=[(\[{{]{_SOMETHING}{_CLOSED})"
    rf"|,{_SOMETHING}(?:truth_)?(?:value|label|truth|holds){_SOMETHING}:){_SOMETHING}{_NAMED}{_OPENED}{_WORD}"
)
"""After an atom that begins a line, more is understood: quotes, arrows, dashes, table cells, the line below, JSON."""
_ARROW = r"[-=~]{1,3}>|[\u2190-\u21ff\u2794-\u27bf\u27f0-\u27ff\u2900-\u297f]|to\b"
_THEN = re.compile(rf"{_SOMETHING}(?P<how>(?P<arrow>{_ARROW})|/|\||or\b|\?){_SOMETHING}{_WORD}?", re.IGNORECASE)
"""What may follow a value and say that it does not decide: a change to another, a choice, a question."""
_TRUTH = r"(true|false|unknown)\b"
_WITHDRAWN = re.compile(
    rf"[^.\n]{{0,30}}\b(?:changed|changes|becomes|became|turned|now|corrected)\b[^.\n]{{0,12}}?\b{_TRUTH}"
    r"|\s*[(\[]\s*(?:before|previous|previously|old|earlier|initial|initially|at first|expected)\s*[)\]]"
    r"|[ \t,;.…–—-]*(?:no longer|not any ?more|no more)\b[ \t.!]*(?=\n|\Z)"
    rf"|[ \t,;.…–—-]*(?:no longer|not any ?more|no more|no)\b\W{{1,6}}{_TRUTH}"
    r"|[\s,;.…–—-]*(?:wait|hmm|actually|correction|rather|sorry|scratch that|on second thoughts?|i mean)"
    rf"[^\n]{{0,80}}?\b{_TRUTH}|[\s,(]*(?:if|unless)\b[^\n]{{0,80}}?\b{_TRUTH}",
    re.IGNORECASE,
)
"""What may follow a value and take it back, unless the word at its end is the same value."""
_FROM_TO = re.compile(
    r"[ \t]*[:：=|][ \t]*(?:it |has )?(?:was|changed from|from|previously|before|expected|initially)\b"
    r"[ \t:]*(?:true|false|unknown)\b[^\w\n]{0,4}(?:and |but )?(?:it )?(?:is |has )?"
    rf"(?:now|currently|to|observed|after(?:wards)?|became|becomes)\b[ \t:]*(?:it )?(?:is |as )?{_TRUTH}",
    re.IGNORECASE,
)
"""A value with the one before it."""
_DENIED = re.compile(r"(?:\bnot[ \t]*[(]?|¬)[ \t]*\Z|(?<![\w~!])[!~]\Z", re.IGNORECASE)
"""What makes an atom its opposite when it stands before it."""
_ENDS = re.compile(r"[ \t]*(?:[.,;:!。，；)\]}|\"'_…(–—-]|\n|\Z)")
_REPEATED = re.compile(rf"[ \t]*+[,;.(:–-]?[ \t]*+{_TRUTH}", re.IGNORECASE)
"""What follows another word for a value: a value, which has to be the same."""
_BEGINS = re.compile(r"-\w|\s*\bor[\s.…]*\Z", re.IGNORECASE)
"""What makes a value the beginning of something else: "true-ish", or an answer that ends with "True or"."""
_WIDE = {code: code - 0xFEE0 for code in range(0xFF01, 0xFF5F)} | dict.fromkeys(
    (0xA0, 0x3000, 0xFEFF, *range(0x2000, 0x2010), *range(0x202A, 0x2030), *range(0x205F, 0x206A), 0xFE0F), " "
)
"""Full-width letters, digits and signs, to plain ones; odd and invisible spaces to one: a character for a character."""
_QUOTED = re.compile(r"\([^()\n]{0,200}[\"'“”‘’][^()\n]{0,200}\)")
_ATOM_AHEAD = r"(?![ \t]*[A-Za-z_][\w\-]*[ \t]*\([^()]*\)[ \t]*[:=])"
THIRD_SECTION = re.compile(rf"^[ \t#>\-]*(?:section[ \t]*)?3[.):](?!\d){_ATOM_AHEAD}", re.IGNORECASE | re.MULTILINE)
_VALUE_ALONE = re.compile(rf"^[^\w\n]*+{_TRUTH}[^\w\n]*+\n", re.IGNORECASE | re.MULTILINE)
_LINE_START = re.compile(
    r"\n[ \t>#+\-\d.)|\"'_•–]*(?:\{\s*[\"'](?:atom|predicate|fact|name)[\"']\s*:\s*[\"'])?"
    r"(?:not[ \t]*[(]?|[¬!~])?[ \t]*\Z",
    re.IGNORECASE,
)


Value = TypeVar("Value")
"""What an answer says about an atom."""


@dataclass(frozen=True)  # no slots: a frozen generic class with slots cannot be made through ParsedLabels
class Parsed(Generic[Value]):
    """The value of every queried atom that the answer gave one, and counts of what could not be used.

    ``other_words`` counts values that are neither True, False nor Unknown; ``unasked`` counts values for atoms that
    were not in the query; ``missing`` lists queried atoms without a value; ``places`` says where in the answer the
    word stands that gave an atom its value; ``text`` is the answer as it was read.
    """

    values: dict[str, Value]
    missing: tuple[str, ...]
    other_words: int
    unasked: int
    places: dict[str, int] = field(default_factory=dict)
    text: str = ""


ParsedLabels = Parsed[Label]


@dataclass(frozen=True, slots=True)
class _Statement:
    """``atom: WORD`` at a place in the text; ``leads`` when its line begins with it, list markers aside.

    ``value`` is ``None`` for a word that is no value, and for one that does not decide: then ``undecided``.
    """

    atom: str
    value: Label | None
    start: int
    word_start: int
    leads: bool
    undecided: bool


def parse_labels(answer: str, queried: Sequence[str]) -> ParsedLabels:
    """Read ``name(args): WORD`` lines.

    When the answer has a third section with values in it, only that section counts: the first two speak of expected
    and observed changes. The line that begins with an atom decides about it, the last such line if there are several;
    values inside explanations count only for atoms without a line of their own. Where the text below the last such line
    says otherwise about an atom, it has no value: it will be asked about again.
    """
    text = clean(_QUOTED.sub(_unquoted, answer.translate(_WIDE)))
    statements = list(_statements(text))
    if statements:
        begins = [h.end() for h in THIRD_SECTION.finditer(text) if h.end() <= statements[-1].start]
        statements = [s for s in statements if s.start >= max(begins, default=0)]
    asked = QueriedAtoms(queried)
    inside: dict[str, tuple[Label, int]] = {}
    leading: dict[str, tuple[Label, int]] = {}
    other_words = unasked = 0
    for statement in statements:
        atom = asked.find(statement.atom)
        if atom is None:
            unasked += 1
        elif statement.value is None:
            other_words += 1
            if statement.leads and statement.undecided:
                leading.pop(atom, None)
        else:
            (leading if statement.leads else inside)[atom] = statement.value, statement.word_start
    below = max((place for _, place in leading.values()), default=0)
    revoked = {
        a for a, (value, place) in inside.items()
        if place > below and "\n" in text[below:place] and a in leading and leading[a][0] != value
    }  # fmt: skip
    found = {a: v for a, v in (inside | leading).items() if a not in revoked}
    values = {atom: found[atom][0] for atom in queried if atom in found}
    raw = kept(answer) if values else []
    places = {atom: raw[found[atom][1]] for atom in values}
    return ParsedLabels(values, tuple(a for a in queried if a not in found), other_words, unasked, places, answer)


def _unquoted(match: re.Match[str]) -> str:
    """Arguments without their quotes, at the same places."""
    return re.sub("[\"'“”‘’]", " ", match[0])


def _statements(text: str) -> Iterator[_Statement]:
    first = next(mentions(text), None)
    headed = first is not None and _VALUE_ALONE.search(text, 0, first.start) is not None
    for mention in mentions(text):
        near = "\n" + text[: mention.start] if mention.start < 20 else text[mention.start - 20 : mention.start]
        leads = _LINE_START.search(near) is not None
        behind = mention.end
        if word := _FROM_TO.match(text, behind) or (_LINE_VALUE if leads else _VALUE).match(text, behind):
            below = headed and "\n" in text[behind : word.start(1)]  # that value may head the atoms below it
            value = None if below else _decided(text, word)
            undecided = value is None and word[1].lower() in _WORDS
            if _DENIED.search(near):
                undecided, value = value != Label.TRUE, Label.FALSE if value == Label.TRUE else None
            yield _Statement(str(mention), value, mention.start, word.start(1), leads, undecided)


def _decided(text: str, word: re.Match[str]) -> Label | None:
    """The value that the word after an atom gives, together with what follows it."""
    value, end = ALL_WORDS.get(word[1].lower()), word.end(1)
    if value is None:
        return None
    if word[1].lower() not in _WORDS:
        if (same := _REPEATED.match(text, end)) and _WORDS[same[1].lower()] != value:
            return None  # "No, True"
        if not same and not _ENDS.match(text, end):
            return None
        end = same.end() if same else end
    if _BEGINS.match(text, end):
        return None
    while then := _THEN.match(text, end):
        other = ALL_WORDS.get((then[3] or "").lower())
        if then["how"] == "?" or (other is not None and other != value and not then["arrow"]):
            return None
        if other is None:
            break
        value, end = other, then.end()
    if withdrawn := _WITHDRAWN.match(text, end):
        said = next((word for word in withdrawn.groups() if word), None)
        return value if said and _WORDS[said.lower()] == value else None
    return value


class QueriedAtoms:
    """Queried atoms by their writing: as asked, or else whatever differs only in spaces, ``-`` for ``_``, and case."""

    def __init__(self, queried: Sequence[str]) -> None:
        self._plain = {_plain(atom): atom for atom in queried}
        folded = Counter(plain.lower() for plain in self._plain)
        self._folded = {p.lower(): atom for p, atom in self._plain.items() if folded[p.lower()] == 1}

    def find(self, text: str) -> str | None:
        """The queried atom that ``text`` writes, or none."""
        plain = _plain(text)
        return self._plain.get(plain) or self._folded.get(plain.lower()) or self._folded.get(plain.lower().lstrip("_"))


def _plain(atom: str) -> str:
    return re.sub(r"\s+", "", atom).replace("-", "_")


def value_lines(values: Mapping[str, Label]) -> str:
    """The bare ``atom: value`` lines of labels, in their order."""
    return "\n".join(f"{atom}: {value.word.capitalize()}" for atom, value in values.items())
