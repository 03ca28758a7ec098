"""Proposed atoms as a pool of predicates (method 2.4, 2.5)."""

from __future__ import annotations

from collections.abc import Iterable

from pix2pred.predicates.frugal.definitions import Definition
from pix2pred.predicates.proposing.propose import Proposal
from pix2pred.structs import Candidate, FromVLM, Predicate, Type


def lift(proposals: Iterable[Proposal], taken: Iterable[str] = ()) -> tuple[Candidate, ...]:
    """The pool: one predicate per word and types of arguments, with the first definition that was given of it, if any.

    A word that an earlier line names as a word for the same or the contrary is not a predicate of its own. Names are
    numbered per word. ``taken`` are names already in use. A visual predicate costs its arity (4.5).
    """
    definitions: dict[tuple[str, tuple[Type, ...]], Definition] = {}
    by_word: dict[str, Definition] = {}
    covered: set[tuple[str, tuple[Type, ...]]] = set()
    for atom in (atom for proposal in proposals for atom in proposal.accepted):
        types = tuple(o.type for o in atom.objects)
        if (atom.name, types) in covered or (atom.name, types) in definitions:
            continue
        definition = atom.definition or Definition()
        if not definition.meaning:
            definition = by_word.get(atom.name, definition)
        by_word.setdefault(atom.name, definition)
        definitions[atom.name, types] = definition
        covered |= {(word, types) for word in (*definition.also, *definition.opposite)}
    used = set(taken)
    pool, numbers = [], dict[str, int]()
    for word, types in sorted(definitions, key=lambda key: (key[0], [t.name for t in key[1]])):
        number = numbers[word] = numbers.get(word, -1) + 1
        name = f"{word}{number}"
        while name in used:
            name = f"{word}_{number}" if name == f"{word}{number}" else name + "_"
        used.add(name)
        one = definitions[word, types]
        source = FromVLM(word, one.also, one.opposite, one.changes)
        pool.append(Candidate(Predicate(name, types, source, one.meaning), float(len(types))))
    return tuple(sorted(pool))
