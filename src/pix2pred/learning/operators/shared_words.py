"""One predicate for one word: candidates that a model proposed with the same word about sibling types become one.

The pool has a predicate for every word and tuple of types that a model used it with: ``holding0(hand, teabag)`` and
``holding1(hand, ice)``. Where skills are declared for a type above, such as ``item``, and the word was labelled for all
objects of that type, the two are ``holding0(hand, item)``. Nothing more is asked, and no label changes.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from pix2pred.structs import Atom, Candidate, FromVLM, LabelledDemo, Predicate, Skill, TruthTable, Type, groundings

Signature = tuple[Type, ...]


def with_shared_words(table: TruthTable, skills: Iterable[Skill]) -> TruthTable:
    """``table`` with the candidates of a word joined wherever they can be; the joined one has the first one's name."""
    declared = sorted({t for s in skills for t in s.types}, key=lambda t: (-_depth(t), t.name))
    groups: dict[tuple[str, int], list[Candidate]] = defaultdict(list)
    for candidate in sorted(table.pool):
        source = candidate.predicate.source
        if isinstance(source, FromVLM):
            groups[source.phrase, candidate.predicate.arity].append(candidate)
    joined: dict[Predicate, Predicate] = {}
    for group in groups.values():
        signatures = [c.predicate.types for c in group]
        types = _declared_above(signatures, declared)
        if types is not None and [types] != signatures and _is_labelled(table, types, signatures):
            one = replace(group[0].predicate, types=types)
            joined |= {c.predicate: one for c in group}
    if not joined:
        return table
    pool: dict[Predicate, Candidate] = {}
    for c in table.pool:
        one = joined.get(c.predicate, c.predicate)
        pool[one] = Candidate(one, max(c.cost, pool[one].cost if one in pool else 0.0))
    return TruthTable(table.initial, tuple(sorted(pool.values())), tuple(_renamed(d, joined) for d in table.demos))


def _depth(t: Type) -> int:
    return 0 if t.parent is None else 1 + _depth(t.parent)


def _declared_above(signatures: Sequence[Signature], declared: Sequence[Type]) -> Signature | None:
    """For each argument the most special declared type that covers all ``signatures``; ``declared`` begins with such.

    A type that no skill is about stays as it is; None when several meet that no declared type covers.
    """
    types = []
    for kinds in map(set, zip(*signatures, strict=True)):
        above = next((d for d in declared if all(t.is_a(d) for t in kinds)), None)
        if above is None and len(kinds) > 1:
            return None
        types.append(next(iter(kinds)) if above is None else above)
    return tuple(types)


def _is_labelled(table: TruthTable, types: Signature, signatures: Sequence[Signature]) -> bool:
    """Whether all atoms over ``types`` were labelled under one of ``signatures``."""
    return all(
        any(all(o.type.is_a(t) for o, t in zip(args, signature, strict=True)) for signature in signatures)
        for demo in table.demos
        for args in groundings(types, demo.objects, distinct=True)
    )


def _renamed(demo: LabelledDemo, joined: Mapping[Predicate, Predicate]) -> LabelledDemo:
    """The demonstration in terms of the joined predicates, atoms sorted; of one labelled twice, the first counts."""
    column: dict[Atom, int] = {}
    for i, atom in enumerate(demo.atoms):
        column.setdefault(Atom(joined.get(atom.predicate, atom.predicate), atom.objects), i)
    atoms = tuple(sorted(column))
    order = np.array([column[a] for a in atoms], dtype=np.intp)
    confidence = None if demo.confidence is None else demo.confidence[:, order]
    return replace(demo, atoms=atoms, values=demo.values[:, order], confidence=confidence)
