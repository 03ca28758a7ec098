"""Reading the predicates that a model wrote as code (method 9): one fenced block, one predicate. Runs nothing."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from pix2pred.predicates.proposing.parse_atoms import LONGEST_NAME
from pix2pred.predicates.proposing.propose import Rejection
from pix2pred.structs import Type

_BLOCK = re.compile(r"^```[a-zA-Z]*[ \t]*\n(.*?)^```", re.DOTALL | re.MULTILINE)
_PREDICATE = re.compile(
    r"^(?P<variable>[A-Za-z]\w*)[ \t]*=[ \t]*Predicate\(\s*(?:name\s*=\s*)?[\"'](?P<name>[A-Za-z]\w*)[\"']\s*,"
    r"\s*(?:types\s*=\s*)?[\[(](?P<types>[^\[\]()]*)[\])]\s*,\s*(?:classifier\s*=\s*)?(?P<function>[A-Za-z]\w*)\s*(?:,\s*)?\)"
    r"[ \t]*(?:#.*)?$",
    re.MULTILINE,
)


@dataclass(frozen=True, slots=True)
class CodePredicate:
    """A predicate as a model wrote it.

    ``types`` are those of its arguments. ``source`` is Python that defines its classifier, called ``function``.
    """

    name: str
    types: tuple[Type, ...]
    function: str
    source: str


def parse_code(answer: str, types: Mapping[str, Type]) -> tuple[list[CodePredicate], list[Rejection]]:
    """The predicates of the fenced blocks, in order, and the blocks that hold none."""
    found: list[CodePredicate] = []
    rejected: list[Rejection] = []
    for match in _BLOCK.finditer(answer.replace("\r\n", "\n")):
        source = match[1]
        header = _PREDICATE.search(source)
        if header is None or not all(header[name].isidentifier() for name in ("variable", "name", "function")):
            rejected.append(Rejection(source, 'no predicate is assigned: Name = Predicate("Name", [types], function)'))
            continue
        names = [t.strip().strip("\"'") for t in header["types"].split(",") if t.strip()]
        unknown = [n for n in names if n not in types]
        if unknown:
            rejected.append(Rejection(source, f"no type is called {unknown[0]!r}"))
        elif len(header["name"]) > LONGEST_NAME:
            rejected.append(Rejection(source, f"the name has more than {LONGEST_NAME} characters"))
        elif not names:
            rejected.append(Rejection(source, "the predicate has no argument"))
        else:
            found.append(CodePredicate(header["name"], tuple(types[n] for n in names), header["function"], source))
    return found, rejected


def distinct(predicates: Iterable[CodePredicate]) -> list[CodePredicate]:
    """The union over demonstrations: the first of every (name, types, source)."""
    return list({(p.name, p.types, p.source): p for p in reversed(list(predicates))}.values())[::-1]
