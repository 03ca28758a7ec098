"""Words that a model named as contraries are candidates with the labels turned round."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from learning.random_tables import candidate, demo, table
from pix2pred.learning.operators.contrary_words import with_contrary_words
from pix2pred.structs import Action, FromVLM, Label, Object, Predicate, Skill, TruthTable, Type

BOX = Type("box")
SHUT = Skill("Shut", (BOX,))
CLOSED = Predicate("closed0", (BOX,), FromVLM("closed", ("shut",), ("open", "unlocked")), "The lid is down.")
RED = Predicate("red0", (BOX,), FromVLM("red", (), ("colourless",), changes=False))
box, other = Object("a", BOX), Object("b", BOX)


def boxes(*pool: Predicate) -> TruthTable:
    """One of two boxes is shut, and nobody knows whether the other one was in the end."""
    states = [[p(box) for p in pool if p != CLOSED] + [CLOSED(other)], [p(x) for p in pool for x in (box, other)]]
    shown = demo("d", {box, other}, [Action(SHUT, (box,))], states)
    values = shown.values.copy()
    values[1, shown.atoms.index(CLOSED(other))] = Label.UNKNOWN
    confidence = np.full(values.shape, 0.75)
    return table([], pool, [replace(shown, values=values, confidence=confidence)])


def test_a_contrary_holds_where_its_word_does_not_and_is_unknown_where_it_is() -> None:
    more = with_contrary_words(boxes(CLOSED, RED))
    (opened,) = [c for c in more.pool if c.predicate not in (CLOSED, RED)]
    assert opened.predicate.source == FromVLM("open", ("unlocked",), ("closed", "shut"))
    assert (opened.predicate.name, opened.predicate.types) == ("open0", (BOX,))
    assert "The lid is down." in opened.predicate.description
    (shown,) = more.demos
    assert list(shown.atoms) == sorted(shown.atoms)
    for x, expected in ((box, [1, 0]), (other, [0, Label.UNKNOWN])):
        assert shown.values[:, shown.atoms.index(opened.predicate(x))].tolist() == expected
    assert shown.confidence is not None and (shown.confidence == 0.75).all()
    (before,) = boxes(CLOSED, RED).demos
    assert shown.restricted([CLOSED, RED]) == before


def test_of_a_word_and_its_contrary_the_one_that_was_asked_about_is_cheaper() -> None:
    costs = {c.predicate.name: c.cost for c in with_contrary_words(boxes(CLOSED)).pool}
    assert costs["closed0"] < costs["open0"] < costs["closed0"] + 1


def test_a_contrary_that_was_asked_about_itself_is_no_other_candidate() -> None:
    asked = candidate("open", BOX)
    assert {c.predicate for c in with_contrary_words(boxes(CLOSED, asked)).pool} == {CLOSED, asked}


def test_nothing_is_added_where_nothing_was_named() -> None:
    plain = boxes(CLOSED)
    plain = TruthTable((), tuple(replace(c, predicate=candidate("closed0", BOX)) for c in plain.pool), plain.demos)
    assert with_contrary_words(plain) is plain
