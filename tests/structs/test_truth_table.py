"""Labels: three values, restriction to predicates, candidates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pix2pred.structs import (
    Action,
    Atom,
    Candidate,
    FromDomain,
    FromVLM,
    Label,
    LabelledDemo,
    Object,
    Predicate,
    Skill,
    TruthTable,
    Type,
    unknown_as_false,
)
from pix2pred.structs.goals.opposites import contrary

CUP = Type("cup")
A, B = Object("a", CUP), Object("b", CUP)
ON = Predicate("On", (CUP, CUP), FromDomain())
HOT, FULL = Predicate("Hot", (CUP,), FromVLM("Hot")), Predicate("Full", (CUP,), FromVLM("Full"))
WAIT = Action(Skill("Wait", ()), ())
ATOMS = (ON(A, B), HOT(A), FULL(A), HOT(B))
VALUES = np.array(
    [[Label.TRUE, Label.UNKNOWN, Label.FALSE, Label.FALSE], [Label.FALSE, Label.TRUE, Label.UNKNOWN, Label.FALSE]],
    np.int8,
)


def labelled(values: np.ndarray[tuple[int, ...], np.dtype[np.int8]] = VALUES) -> LabelledDemo:
    return LabelledDemo("d", (A, B), (WAIT,), (ON(A, B),), ATOMS, values)


def test_unknown_stays_in_storage_and_reads_as_false() -> None:
    assert unknown_as_false(VALUES).tolist() == [[True, False, False, False], [False, True, False, False]]
    assert labelled().abstract_states() == (frozenset({ON(A, B)}), frozenset({HOT(A)}))


def test_restriction_keeps_the_columns_of_the_predicates() -> None:
    kept = labelled().restricted([HOT])
    assert kept.atoms == (HOT(A), HOT(B))
    assert kept.values.tolist() == [[Label.UNKNOWN, Label.FALSE], [Label.TRUE, Label.FALSE]]
    assert (kept.objects, kept.actions, kept.goal) == ((A, B), (WAIT,), (ON(A, B),))
    assert labelled().restricted([]).values.shape == (2, 0)


def reached(*goals: tuple[Atom, ...]) -> tuple[Atom, ...]:
    """Of ``goals`` the one that was demonstrated, by a last state where ``HOT(A)`` is true and ``FULL(A)`` unknown."""
    return replace(labelled(), goal=goals[0], alternatives=goals[1:]).reached


def test_of_several_goals_the_one_that_the_last_state_contradicts_least_was_demonstrated() -> None:
    assert reached((HOT(B),)) == (HOT(B),), "whatever is said of the only one"
    assert reached((HOT(B),), (HOT(A),)) == (HOT(A),)
    assert reached((HOT(B),), (FULL(A),)) == (FULL(A),), "unknown is less than false"
    assert reached((FULL(A),), (HOT(A), contrary(HOT(B)))) == (HOT(A), contrary(HOT(B)))
    assert reached((contrary(HOT(A)),), (contrary(ON(A, B)),)) == (contrary(ON(A, B)),)
    assert reached((ON(A, B),), (HOT(B), FULL(B))) == (HOT(B), FULL(B)), "what is given weighs more than labels"
    assert reached((HOT(B),), (FULL(B),)) == (HOT(B),), "the first of equals"


@given(st.sets(st.sampled_from([ON, HOT, FULL])))
def test_restriction_and_abstraction_commute(predicates: set[Predicate]) -> None:
    whole = labelled().abstract_states()
    restricted = labelled().restricted(predicates).abstract_states()
    assert restricted == tuple(frozenset(a for a in s if a.predicate in predicates) for s in whole)


def test_labels_must_fit_the_demonstration() -> None:
    with pytest.raises(ValueError, match="shape"):
        labelled(VALUES[:1])


def test_equality_is_by_values() -> None:
    assert labelled() == labelled(VALUES.copy())
    changed = VALUES.copy()
    changed[0, 1] = Label.FALSE
    assert labelled() != labelled(changed)
    assert labelled() != labelled().restricted([HOT])


def test_candidates_are_true_at_least_once_and_sorted() -> None:
    never = Candidate(FULL, 1.0)
    table = TruthTable((ON,), (Candidate(HOT, 1.0), never), (labelled(),))
    assert table.ever_true == {ON, HOT}
    assert table.candidates() == (Candidate(HOT, 1.0),)
    assert [table.count(v) for v in (Label.TRUE, Label.FALSE, Label.UNKNOWN)] == [2, 4, 2]
    values = np.ones((2, 4), np.int8)
    full = TruthTable((ON,), (Candidate(HOT, 1.0), never), (labelled(values),))
    assert [c.predicate.name for c in full.candidates()] == ["Full", "Hot"]


def test_an_empty_table_has_no_candidates() -> None:
    table = TruthTable((), (Candidate(HOT, 1.0),), ())
    assert table.candidates() == ()
    assert table.count(Label.TRUE) == 0
