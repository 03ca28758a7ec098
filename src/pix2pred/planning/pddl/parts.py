"""The parts of a PDDL definition: sections by keyword, parts of actions, declared names."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pix2pred.planning.pddl.syntax import Group, Node, PddlError, TypedWord, Word, as_group, as_word, parse, typed_list

_SECTIONS = {
    "domain": (":requirements", ":types", ":constants", ":predicates", ":functions", ":derived", ":action"),
    "problem": (":domain", ":requirements", ":objects", ":init", ":goal", ":metric"),
}
_SEVERAL = {":derived", ":action"}
"""Sections that may occur more than once."""

_UNSUPPORTED = {
    ":durative-action": "durative actions",
    ":constraints": "constraints on trajectories",
    ":process": "processes",
    ":event": "events",
    ":length": "bounds on the length of plans",
}
_ACTION = (":parameters", ":precondition", ":effect")
RESERVED = {
    "and", "or", "not", "imply", "forall", "exists", "when", "either", "preference", "=", "<", ">", "<=", ">=",
    "assign", "increase", "decrease", "scale-up", "scale-down", "total-cost", "total-time", "number", "define",
}  # fmt: skip
"""Words of the language. Nothing that is written is called like one of them."""

NO_PREDICATES = {
    "and", "or", "not", "imply", "forall", "exists", "when", "=", "assign", "increase", "decrease", "scale-up",
    "scale-down",
}  # fmt: skip
"""Words that cannot name a predicate that is read: conditions or effects begin with them."""


def sections(text: str, kind: str) -> dict[str, list[Group]]:
    """The sections of ``(define (kind NAME) ...)`` by keyword; ``kind`` itself holds its name's group.

    Every keyword but ``:action`` and ``:derived`` occurs at most once. What ``:requirements`` lists is a hint that is
    not needed: what a definition uses is seen from what it says. Raises ``PddlError``.
    """
    top = parse(text)
    if top.head != "define" or len(top.items) < 2 or as_group(top.items[1]).head != kind:
        raise PddlError(top.at, f"expected (define ({kind} NAME) ...)")
    named = as_group(top.items[1])
    if len(named.items) != 2:
        raise PddlError(named.at, f"({kind} ...) takes one name")
    found: dict[str, list[Group]] = {kind: [named]}
    for node in top.items[2:]:
        section = as_group(node)
        if section.head in _UNSUPPORTED:
            raise PddlError(section.at, f"{_UNSUPPORTED[section.head]} ({section.head}) are not supported")
        if section.head not in _SECTIONS[kind]:
            known = " ".join(_SECTIONS[kind])
            raise PddlError(section.at, f"{section.head or 'this'} is no section of a {kind}; known: {known}")
        if section.head in found and section.head not in _SEVERAL:
            raise PddlError(section.at, f"{section.head} stands here a second time")
        found.setdefault(section.head, []).append(section)
    return found


def items(found: dict[str, list[Group]], keyword: str) -> Sequence[Node]:
    """What stands in a section that occurs at most once; nothing when it is absent."""
    return found[keyword][0].items[1:] if keyword in found else ()


def action_parts(action: Group) -> tuple[Word, dict[str, Group]]:
    """The name of an action and its parts by keyword. Raises ``PddlError``."""
    if len(action.items) < 2:
        raise PddlError(action.at, ":action needs a name")
    name = as_word(action.items[1])
    parts: dict[str, Group] = {}
    keys, values = action.items[2::2], action.items[3::2]
    for i, key in enumerate(map(as_word, keys)):
        if key.text not in _ACTION:
            raise PddlError(key.at, f"{key.text} is no part of an action; known: {' '.join(_ACTION)}")
        if key.text in parts:
            raise PddlError(key.at, f"{key.text} stands here a second time")
        if i >= len(values):
            raise PddlError(key.at, f"{key.text} has nothing behind it")
        parts[key.text] = as_group(values[i])
    return name, parts


def declared(nodes: Sequence[Node], kind: str, *, repeatable: bool = False) -> Iterator[TypedWord]:
    """The names of a typed list in which variables, and only they, begin with ``?``.

    No name occurs twice, unless names are ``repeatable``. Raises ``PddlError``.
    """
    seen: set[str] = set()
    for word in typed_list(nodes):
        name = word.name
        if name.text in seen and not repeatable:
            raise PddlError(name.at, f"{kind} {name.text} is declared twice")
        if (kind == "variable") != name.text.startswith("?"):
            raise PddlError(name.at, f"{name.text} is no name of a {kind}: only variables begin with '?'")
        seen.add(name.text)
        yield word
