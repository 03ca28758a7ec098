"""What always holds, and how far labels can be trusted, learned from demonstrations with and without wrong labels."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import burger_truth
from pix2pred.domains.burger import BurgerDomain
from pix2pred.learning import LearningSettings, learn_operators
from pix2pred.learning.invariants import Acquaintance, acquaint
from pix2pred.structs import FromVLM, TruthTable

WORDS = {"cooked": "cooked", "hand_free": "hand_empty"}


def flipped(table: TruthTable, rate: float, seed: int) -> TruthTable:
    rng = np.random.default_rng(seed)
    demos = []
    for demo in table.demos:
        values = demo.values.copy()
        for i, atom in enumerate(demo.atoms):
            if isinstance(atom.predicate.source, FromVLM):
                wrong = rng.random(len(values)) < rate
                values[wrong, i] = 1 - values[wrong, i]
        demos.append(replace(demo, values=values))
    return replace(table, demos=tuple(demos))


def learned(rate: float = 0.0) -> Acquaintance:
    table = burger_truth.true_table("more-stacks", WORDS)
    predicates = (*table.initial, *(c.predicate for c in table.pool))
    operators = learn_operators(table, LearningSettings())
    return acquaint(flipped(table, rate, 1), predicates, operators)


EXPECTED = [
    "exactly one of Clear(?x:item), Holding(*:robot, ?x:item), On(*:item, ?x:item)",
    "exactly one of Holding(*:robot, ?x:item), On(?x:item, *:object), OnGround(?x:item)",
    "exactly one of Holding(?x:robot, *:item), hand_free(?x:robot)",
    "SomewhereAboveAndPrepped(?x0, ?x1) implies cooked(?x1)",
]


@pytest.mark.parametrize("rate", [0.0, 0.02])
def test_invariants_of_the_burger_kitchen_are_found_with_wrong_labels_too(rate: float) -> None:
    found = learned(rate)
    assert [str(i) for i in found.invariants] == EXPECTED
    assert all(i.support >= 6 for i in found.invariants)


def test_error_rates_and_first_states_are_estimated() -> None:
    clean = {r.predicate.name: r for r in learned(0.0).reliability}
    noisy = {r.predicate.name: r for r in learned(0.1).reliability}
    assert set(clean) == {"cooked", "hand_free"}
    for name in clean:
        assert clean[name].error == pytest.approx(0.005, abs=0.004)
        assert 0.04 < noisy[name].error < 0.2
        assert clean[name].unknown == 0
    assert clean["cooked"].initially < 0.1 and clean["hand_free"].initially > 0.9


def test_unknown_labels_are_counted_apart() -> None:
    table = burger_truth.true_table("more-stacks", WORDS)
    demos = []
    for demo in table.demos:
        values = demo.values.copy()
        hidden = [i for i, a in enumerate(demo.atoms) if a.predicate.name == "cooked"]
        values[1::2, hidden] = -1
        demos.append(replace(demo, values=values))
    predicates = (*table.initial, *(c.predicate for c in table.pool))
    operators = learn_operators(table, LearningSettings())
    found = {
        r.predicate.name: r for r in acquaint(replace(table, demos=tuple(demos)), predicates, operators).reliability
    }
    assert 0.4 < found["cooked"].unknown < 0.6 and found["hand_free"].unknown == 0
    assert found["cooked"].error < 0.02


def test_nothing_is_learned_from_nothing() -> None:
    vocabulary = BurgerDomain().vocabulary("more-stacks")
    empty = TruthTable(vocabulary.initial, (), ())
    assert acquaint(empty, vocabulary.initial, ()) == Acquaintance((), ())
