"""Candidates for words that a model named as the contrary of a word that it labelled.

The frugal protocol asks about one word per meaning. Operators have positive preconditions alone, so that a skill which
needs a closed lid and one which needs an open lid take both words; the labels of one are those of the other turned
round, and nothing more is asked.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pix2pred.structs import Atom, Candidate, FromVLM, Label, LabelledDemo, Predicate, TruthTable

UNASKED = 0.5
"""Arguments that a word costs beyond its own since it was not asked about itself: of two that serve alike the one that
was asked about is taken."""


def with_contrary_words(table: TruthTable) -> TruthTable:
    """``table`` with a candidate for the contrary of every candidate that can change and for which a word was named."""
    used = {p.name for p in (*table.initial, *(c.predicate for c in table.pool))}
    said = {
        (c.predicate.source.phrase, c.predicate.types) for c in table.pool if isinstance(c.predicate.source, FromVLM)
    }
    contraries: dict[Predicate, Predicate] = {}
    pool = list(table.pool)
    for candidate in sorted(table.pool):
        predicate, source = candidate.predicate, candidate.predicate.source
        if not isinstance(source, FromVLM) or not source.opposite or not source.changes:
            continue
        word, *others = source.opposite
        if (word, predicate.types) in said:
            continue
        said.add((word, predicate.types))
        number = next(n for n in range(len(used) + 1) if f"{word}{n}" not in used)
        turned = FromVLM(word, tuple(others), (source.phrase, *source.also), source.changes)
        meaning = f"The contrary of {source.phrase}: {predicate.description}" if predicate.description else ""
        contraries[predicate] = Predicate(f"{word}{number}", predicate.types, turned, meaning)
        used.add(f"{word}{number}")
        pool.append(Candidate(contraries[predicate], candidate.cost + UNASKED))
    if not contraries:
        return table
    demos = tuple(_with_contraries(demo, contraries) for demo in table.demos)
    return TruthTable(table.initial, tuple(sorted(pool)), demos)


def _with_contraries(demo: LabelledDemo, contraries: dict[Predicate, Predicate]) -> LabelledDemo:
    """The demonstration with atoms of the contraries, sorted; what is unknown stays so."""
    columns = [i for i, atom in enumerate(demo.atoms) if atom.predicate in contraries]
    turned = demo.values[:, columns]
    turned = np.where(turned == Label.UNKNOWN, Label.UNKNOWN, 1 - turned).astype(demo.values.dtype)
    atoms = (*demo.atoms, *(Atom(contraries[demo.atoms[i].predicate], demo.atoms[i].objects) for i in columns))
    order = sorted(range(len(atoms)), key=lambda i: atoms[i])
    values = np.concatenate([demo.values, turned], axis=1)[:, order]
    confidence = demo.confidence
    if confidence is not None:
        confidence = np.concatenate([confidence, confidence[:, columns]], axis=1)[:, order]
    return replace(demo, atoms=tuple(atoms[i] for i in order), values=values, confidence=confidence)
