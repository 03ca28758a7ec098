"""Forms in which models write values that are no lines ``atom: VALUE``, turned into such lines (method 3.6)."""

from __future__ import annotations

import csv
import html
import re
from collections.abc import Iterator, Sequence

from pix2pred.predicates.labelling.parse_labels import ALL_WORDS, THIRD_SECTION, QueriedAtoms, value_lines
from pix2pred.predicates.labelling.structured import PAST
from pix2pred.predicates.proposing.parse_atoms import Mention, clean, mentions
from pix2pred.structs import Label

_INLINE = re.compile(r"</?(?:b|i|u|em|strong|code|span|mark|font|small|kbd|tt|sub|sup|ins|a)(?:\s[^<>]{0,200})?>", re.I)
_BREAKS = re.compile(r"<(?:br|/?(?:li|p|tr|div|ul|ol|dl|table|pre|h[1-6])|dt)(?:\s[^<>]{0,200})?/?>", re.I)
_CELL = re.compile(r"<(?:td|th|dd|dt)(?:\s[^<>]{0,200})?>", re.I)
_UNSEEN = re.compile(r"<!--.*?(?:-->|\Z)|</(?:td|th|dd|dt)\s?>", re.I | re.S)
_ROW = re.compile(r"<tr\b[^<>]{0,200}>.{0,2000}?</tr>", re.I | re.S)
_NAMED = re.compile(r"<\w{1,40}\s+\w{1,40}=\"([^\"<>()]{1,100}\([^\"<>()]{0,200}\))\"\s*>")
_WRAPPED = re.compile(r"\\(?:boxed|fbox|text\w{0,6}|math\w{1,6}|operatorname)\s?\{([^{}]*)\}")
_LATEX_ROW = re.compile(r"\\\\|\\hline\b|\\(?:begin|end)\{[^{}]{1,20}\}(?:\{[^{}]{0,20}\})?")
_NESTED = 4
"""How deep a value is packed in commands of LaTeX."""
_LONGEST_ROW = 10_000
"""Characters of a line beyond which it is no row of a table."""
_COLOURS = re.compile(r"\x1b\[[\d;]{0,20}m")
_MARKS = {"[x]": Label.TRUE, "[ ]": Label.FALSE, "[]": Label.FALSE, "☑": Label.TRUE, "☐": Label.FALSE}
_MARKS |= dict.fromkeys("✓✔✅", Label.TRUE) | dict.fromkeys("✗✘❌✕✖", Label.FALSE)
_EMPTY = {"[ ]", "[]", "☐"}
"""Boxes that nobody ticked: they say something only beside others that somebody did."""
_MARKED = re.compile(r"[\s>+\-•\d.)]*(\[[xX ]?\]|[☑☐✓✔✅✗✘❌✕✖])\ufe0f?\s*")
_DENIES = re.compile(r"\b(?:not|no|never|nothing|none|cannot|false|unknown|unclear)\b|n['’]t\b|\?", re.I)
_AFFIRMS = re.compile(r"\b(?:true|yes|unknown|unclear)\b|\?", re.I)
_AGAINST = {Label.TRUE: _DENIES, Label.FALSE: _AFFIRMS, Label.UNKNOWN: re.compile(r"\b(?:true|false)\b", re.I)}
"""Words beside a value that leave it in doubt."""
_HEADING = re.compile(
    r"[\s#>+\-•\d.)]*(true|false|unknown)(?: (?:predicate|atom|fact|statement|value)s?)?\s*([:：]?)\s*\Z", re.I
)
_VALUE_FIRST = re.compile(r"[\s#>+\-•\d.)|\"']*(true|false|unknown)[\"']?\s*[:：|,;\t]", re.I)
_VALUE_LINE = re.compile(
    r"[\s#>+\-•\"'_]*(?:truth[ _])?(?:value|label|answer|verdict|truth)[\"'_]*\s*[:：=][\s\"']*(\w+)[\s\"'.,]*\Z", re.I
)
_LAST_WORD = re.compile(
    r"[.,;:|–—→>-]\s*(?:so |hence |therefore |thus )?(?:it is )?(true|false|unknown)[\s.\"']*\Z", re.I
)
_OUTSIDE = re.compile(r"[\s#>+\-•|\d.)\"':?]*\Z")
"""All that a line holds besides an atom that stands alone."""


def without_markup(answer: str) -> str:
    """``answer`` without HTML, entities, LaTeX and colours of a terminal; unchanged where it has none of them.

    Rows and items become lines, cells are set apart by ``|``, and columns of tables that tell the state before are
    left out. Struck-out text keeps its tags, so that nothing takes it for a value.
    """
    text = _COLOURS.sub("", answer)
    if "<" in text or "&" in text:
        text = _UNSEEN.sub("", _NAMED.sub(r"\n\1: ", _ROW.sub(lambda row: " ".join(row[0].split()), text)))
        text = _CELL.sub(
            " | ", _BREAKS.sub(lambda tag: "\n" + (tag[0] if "dt" in tag[0] else ""), _INLINE.sub("", text))
        )
        text = html.unescape(text)
    if "\\" in text:
        for _ in range(_NESTED):
            text = _WRAPPED.sub(r"\1", text)
        if "\\begin" in text:
            text = re.sub(r"&\s*(?=[:=])", "", _LATEX_ROW.sub("\n", text)).replace("&", " | ")
        if text != answer:
            text = text.replace("$", "")
    return "\n".join(_present(text.split("\n"))) if "|" in text else text


def _present(lines: Sequence[str]) -> Iterator[str]:
    """Lines without the cells of columns whose heading names the state before, or an expected one."""
    past: list[int] = []
    for line in lines:
        cells = line.split("|")
        if len(cells) < 3:
            past = past if not line.strip() else []
        elif not any(mentions(clean(line))) and (found := [i for i, cell in enumerate(cells) if PAST.match(cell)]):
            past = found
        yield "|".join(cell for i, cell in enumerate(cells) if i not in past) if past else line


def as_lines(answer: str, queried: Sequence[str]) -> str:
    """``answer`` as lines ``atom: VALUE`` for the asked atoms whose value a line of it says unmistakably.

    Read are rows of tables in any order of columns, lists with ticked and empty boxes, atoms below or behind a value,
    values on a line of their own below an atom and its explanation, and explanations that end in the value. Where the
    answer has a third section, that is read. An atom that is given two values has none.
    """
    asked, plain = QueriedAtoms(queried), clean(answer)
    said = [line for line in plain.splitlines() if line.strip()]
    if len(queried) == 1 and len(said) == 1 and (value := _value(said[0])) is not None:
        return value_lines({queried[0]: value})
    for begin in [*[match.end() for match in THIRD_SECTION.finditer(plain)][-1:], 0]:
        found: dict[str, set[Label]] = {}
        for atom, value in _given(plain[begin:].splitlines(), asked):
            found.setdefault(atom, set()).add(value)
        if found:
            return value_lines({atom: one for atom, (one, *more) in found.items() if not more})
    return ""


def _given(lines: Sequence[str], asked: QueriedAtoms) -> Iterator[tuple[str, Label]]:
    ticked = any((mark := _MARKED.match(line)) and mark[1] not in _EMPTY for line in lines)
    heading: Label | None = None
    above, headed, begun = "", False, False
    for line in lines:
        found = list(mentions(line))
        begun = begun or bool(found)
        if (title := _HEADING.match(line)) and (title[2] or headed or not begun):
            heading, headed = ALL_WORDS[title[1].lower()], True
        elif not found and (named := _VALUE_LINE.match(line)) and (value := _value(named[1])) is not None:
            yield from [(above, value)] if above else []
            above = ""
        elif line.strip() and re.search(r"\w", "".join(_around(line, found))):
            heading = None
        above = _alone(line, found, asked) or ("" if found else above)
        for mention, value in _values(line, found, heading, ticked):
            if atom := asked.find(str(mention)):
                yield atom, value


def _around(line: str, found: Sequence[Mention]) -> list[str]:
    """The parts of a line before, between and behind its atoms."""
    edges = [0, *(edge for mention in found for edge in (mention.start, mention.end)), len(line)]
    return [line[edges[i] : edges[i + 1]] for i in range(0, len(edges), 2)]


def _values(
    line: str, found: Sequence[Mention], heading: Label | None, ticked: bool
) -> Iterator[tuple[Mention, Label]]:
    """The atoms of a line with the values that the line, or the heading it stands under, gives them."""
    if not found:
        return
    first, *between, rest = _around(line, found)
    bare = not re.search(r"\w", "".join(between))
    if (before := _VALUE_FIRST.match(first)) and bare and _OUTSIDE.match(first[before.end() :]):
        value = ALL_WORDS[before[1].lower()]
        yield from ((mention, value) for mention in found if not _AGAINST[value].search(rest))
    elif heading is not None and bare and _OUTSIDE.match(first) and _OUTSIDE.match(rest.rstrip(" .,;")):
        yield from ((mention, heading) for mention in found)
    elif len(found) == 1:
        said = (_marked(first, rest, ticked), _in_cells(line, found[0]), _ends(first, rest))
        yield from ((found[0], value) for value in said if value is not None)


def _marked(first: str, rest: str, ticked: bool) -> Label | None:
    """What the box or tick before an atom says, unless the words behind the atom could say something else."""
    mark = _MARKED.fullmatch(first)
    if mark is None or (not ticked and mark[1] in _EMPTY):
        return None
    value = _MARKS[mark[1].lower()]
    return None if _AGAINST[value].search(rest) else value


def _in_cells(line: str, mention: Mention) -> Label | None:
    """The one value among the cells of a row in which the atom has a cell of its own."""
    marked = line[: mention.start] + "@" + line[mention.end :]
    for separator in "|\t;,":
        if separator not in marked or len(marked) > _LONGEST_ROW:
            continue
        row = next(csv.reader([marked], delimiter=separator, skipinitialspace=True))
        cells = [cell.strip(" \"'_") for cell in row]
        if "@" not in cells:
            continue
        beside = [cells[i] for i in (cells.index("@") - 1, cells.index("@") + 1) if 0 <= i < len(cells)]
        numbers = len([cell for cell in cells if cell]) == 2  # otherwise a figure may number the rows
        said = [c for c in (cells if separator != "," else beside) if numbers or not c.isdigit()]
        values = [value for cell in said if (value := _value(cell)) is not None]
        return values[0] if len(values) == 1 else None
    return None


def _ends(first: str, rest: str) -> Label | None:
    """The value with which the explanation of an atom ends, where nothing before it speaks against it."""
    if (found := _LAST_WORD.search(rest)) is None or not _OUTSIDE.match(first):
        return None
    value = ALL_WORDS[found[1].lower()]
    why = rest[: found.start(1)]
    return None if _AGAINST[value].search(why) or re.search(r"\b(?:true|false|unknown)\b", why, re.I) else value


def _alone(line: str, found: Sequence[Mention], asked: QueriedAtoms) -> str:
    """The asked atom that a line consists of, under a name or not."""
    if len(found) != 1:
        return ""
    first = re.sub(r"(?:atom|predicate|fact|name)[\"']?\s*:", "", line[: found[0].start], flags=re.I)
    return asked.find(str(found[0])) or "" if _OUTSIDE.match(first) and _OUTSIDE.match(line[found[0].end :]) else ""


def _value(text: str) -> Label | None:
    return ALL_WORDS.get(text.strip(" \t.\"'_\ufe0f").lower())
