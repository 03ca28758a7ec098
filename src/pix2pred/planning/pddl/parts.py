"""The parts of a PDDL definition: sections by keyword, conjunctions, declared names. What is not supported is said."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pix2pred.planning.pddl.syntax import Group, PddlError, Word, as_group, as_word, parse, typed_list

REQUIREMENTS = (":strips", ":typing", ":equality", ":negative-preconditions", ":action-costs")
_SECTIONS = {
    "domain": (":requirements", ":types", ":constants", ":predicates", ":functions", ":action"),
    "problem": (":domain", ":requirements", ":objects", ":init", ":goal", ":metric"),
}
_ACTION = (":parameters", ":precondition", ":effect")
_UNSUPPORTED = {
    "or": "disjunctions",
    "imply": "implications",
    "forall": "quantifiers",
    "exists": "quantifiers",
    "when": "conditional effects",
    "=": "equalities other than (not (= ?a ?b))",
    **dict.fromkeys((">", "<", ">=", "<="), "numeric conditions"),
    **dict.fromkeys(("assign", "increase", "decrease", "scale-up", "scale-down"), "numeric effects"),
}
RESERVED = {*_UNSUPPORTED, "and", "not"}
"""Words that cannot name a predicate."""


def sections(text: str, kind: str) -> dict[str, list[Group]]:
    """The sections of ``(define (kind NAME) ...)`` by keyword; ``kind`` itself holds its name's group.

    Every keyword but ``:action`` occurs at most once. Raises ``PddlError``.
    """
    top = parse(text)
    if top.head != "define" or len(top.items) < 2 or as_group(top.items[1]).head != kind:
        raise PddlError(top.line, f"expected (define ({kind} NAME) ...)")
    named = as_group(top.items[1])
    if len(named.items) != 2:
        raise PddlError(named.line, f"({kind} ...) takes one name")
    found: dict[str, list[Group]] = {kind: [named]}
    for node in top.items[2:]:
        section = as_group(node)
        if section.head not in _SECTIONS[kind]:
            known = " ".join(_SECTIONS[kind])
            raise PddlError(section.line, f"{section.head or 'this'} is no section of a {kind}; known: {known}")
        if section.head in found and section.head != ":action":
            raise PddlError(section.line, f"{section.head} stands here a second time")
        found.setdefault(section.head, []).append(section)
    for group in found.get(":requirements", ()):
        for word in (as_word(item) for item in group.items[1:]):
            if word.text not in REQUIREMENTS:
                hint = f"supported: {' '.join(REQUIREMENTS)}; leave it out if nothing needs it"
                raise PddlError(word.line, f"requirement {word.text} is not supported ({hint})")
    for group in found.get(":functions", ()):
        for node in group.items[1:]:
            if isinstance(node, Group) and node.head != "total-cost":
                raise PddlError(node.line, "numeric fluents other than (total-cost) are not supported")
    return found


def items(found: dict[str, list[Group]], keyword: str) -> Sequence[Word | Group]:
    """What stands in a section that occurs at most once; nothing when it is absent."""
    return found[keyword][0].items[1:] if keyword in found else ()


def action_parts(action: Group) -> tuple[Word, dict[str, Group]]:
    """The name of an action and its parts by keyword."""
    if len(action.items) < 2:
        raise PddlError(action.line, ":action needs a name")
    name = as_word(action.items[1])
    parts: dict[str, Group] = {}
    keys, values = action.items[2::2], action.items[3::2]
    for i, key in enumerate(map(as_word, keys)):
        if key.text not in _ACTION:
            raise PddlError(key.line, f"{key.text} is no part of an action; known: {' '.join(_ACTION)}")
        if key.text in parts:
            raise PddlError(key.line, f"{key.text} stands here a second time")
        if i >= len(values):
            raise PddlError(key.line, f"{key.text} has nothing behind it")
        parts[key.text] = as_group(values[i])
    return name, parts


def conjuncts(node: Group | None) -> Iterator[Group]:
    """The atoms and negations of a conjunction, nested ones flattened, ``(increase (total-cost) N)`` left out."""
    if node is None or not node.items:
        return
    if node.head == "and":
        for item in node.items[1:]:
            yield from conjuncts(as_group(item))
    elif not _is_cost(node):
        if node.head in _UNSUPPORTED:
            raise PddlError(node.line, f"{_UNSUPPORTED[node.head]} ({node.head} ...) are not supported")
        yield node


def negated(group: Group) -> Group:
    """What ``(not ...)`` denies."""
    if len(group.items) != 2:
        raise PddlError(group.line, "(not ...) takes one condition")
    return as_group(group.items[1])


def initial_facts(nodes: Sequence[Word | Group]) -> Iterator[Group]:
    """The atoms of ``:init``; the start value of the costs is left out."""
    for group in map(as_group, nodes):
        if group.head == "not":
            raise PddlError(group.line, "negative facts are not supported: what :init does not list is false")
        if group.head != "=":
            yield group
        elif as_group(group.items[1] if len(group.items) > 1 else group).head != "total-cost":
            raise PddlError(group.line, "numeric fluents other than (total-cost) are not supported")


def declared(nodes: Sequence[Word | Group], kind: str) -> Iterator[tuple[Word, Word]]:
    """(name, type) pairs of a typed list in which no name occurs twice and variables begin with ``?``."""
    seen: set[str] = set()
    for name, type_word in typed_list(nodes):
        if name.text in seen:
            raise PddlError(name.line, f"{kind} {name.text} is declared twice")
        if (kind == "variable") != name.text.startswith("?"):
            raise PddlError(name.line, f"{name.text} is no name of a {kind}: only variables begin with '?'")
        seen.add(name.text)
        yield name, type_word


def _is_cost(node: Group) -> bool:
    return node.head == "increase" and len(node.items) > 1 and as_group(node.items[1]).head == "total-cost"
