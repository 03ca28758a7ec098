"""Proposed atoms as a pool of predicates (method 2.4, 2.5)."""

from __future__ import annotations

from collections.abc import Iterable

from pix2pred.predicates.proposing.propose import Proposal
from pix2pred.structs import Candidate, FromVLM, Predicate, Type


def lift(proposals: Iterable[Proposal], taken: Iterable[str] = ()) -> tuple[Candidate, ...]:
    """The pool: one predicate per distinct (name, object types), numbered per name (method 2.4, 2.5).

    ``taken`` are names already in use. A visual predicate costs its arity (4.5).
    """
    signatures: dict[str, set[tuple[Type, ...]]] = {}
    for proposal in proposals:
        for atom in proposal.accepted:
            signatures.setdefault(atom.name, set()).add(tuple(o.type for o in atom.objects))
    used = set(taken)
    pool = []
    for base in sorted(signatures):
        for i, types in enumerate(sorted(signatures[base], key=lambda ts: [t.name for t in ts])):
            name = f"{base}{i}"
            while name in used:
                name = f"{base}_{i}" if name == f"{base}{i}" else name + "_"
            used.add(name)
            pool.append(Candidate(Predicate(name, types, FromVLM(base)), float(len(types))))
    return tuple(sorted(pool))
