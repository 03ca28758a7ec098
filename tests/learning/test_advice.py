"""Readings, doubts and advice on tables small enough to work out by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from learning.published import published
from learning.random_tables import BALL, BOX, candidate, demo, given, table
from pix2pred.learning import SupportKind, advice_document, advise, operator_support
from pix2pred.learning.labels.advice import with_labels
from pix2pred.learning.labels.doubts import doubted
from pix2pred.structs import (
    Action,
    Atom,
    Label,
    LabelledDemo,
    LiftedAtom,
    Object,
    Operator,
    Skill,
    TruthTable,
    Variable,
)

HEAT, SERVE = Skill("Heat", (BALL,)), Skill("Serve", (BALL,))
HOT, COLD, DONE = candidate("hot", BALL), candidate("cold", BALL), given("Done", BALL)
A, B, C = Object("a", BALL), Object("b", BALL), Object("c", BOX)
X = Variable("?x", BALL)


def served(name: str, *states: list[Atom]) -> LabelledDemo:
    """Heat a, then serve it; ``states`` are what was labelled true before, between and after."""
    return demo(name, {A, B}, [Action(HEAT, (A,)), Action(SERVE, (A,))], states, [DONE(A)])


RIGHT: tuple[list[Atom], ...] = ([], [HOT(A)], [HOT(A), DONE(A)])


def lifted(*names: object) -> frozenset[LiftedAtom]:
    return frozenset(LiftedAtom(p, (X,)) for p in names)  # type: ignore[arg-type]


def operator(name: str, skill: Skill, pre: frozenset[LiftedAtom], add: frozenset[LiftedAtom]) -> Operator:
    return Operator(name, (X,), pre, add, frozenset(), skill, (X,))


MODEL = (operator("Op0", HEAT, lifted(), lifted(HOT)), operator("Op1", SERVE, lifted(HOT), lifted(DONE)))


def test_transitions_support_operators_whose_effects_alone_occur() -> None:
    found = operator_support(MODEL, [served("d", *RIGHT)])
    assert [(r.operator, r.step, r.binding, r.verdict) for r in found] == [
        ("Op0", 0, ("a",), SupportKind.SUPPORTS),
        ("Op1", 1, ("a",), SupportKind.SUPPORTS),
    ]
    assert all((r.unmet, r.absent, r.surplus) == ((), (), ()) for r in found)


def test_a_transition_says_what_it_has_against_an_operator() -> None:
    first, second = operator_support(MODEL, [served("d", [], [HOT(B)], [HOT(B), DONE(A)])])
    assert (first.verdict, first.absent, first.surplus) == (SupportKind.CONTRADICTS, ("+hot(a)",), ("+hot(b)",))
    assert (second.verdict, second.unmet) == (SupportKind.UNMET, ("hot(a)",))
    assert (second.absent, second.surplus) == ((), ())


def test_an_operator_that_neither_applies_nor_explains_is_not_read() -> None:
    assert [r.operator for r in operator_support(MODEL, [served("d", [], [HOT(A)], [])])] == ["Op0", "Op1"]
    assert [r.operator for r in operator_support(MODEL, [served("d", [], [], [])])] == ["Op0"]


def test_an_effect_that_was_there_before_is_nothing_against_an_operator() -> None:
    again = operator_support(MODEL, [served("d", [HOT(A)], [HOT(A)], [HOT(A), DONE(A)])])
    assert {(r.operator, r.verdict, r.absent) for r in again} == {
        ("Op0", SupportKind.SUPPORTS, ()),
        ("Op1", SupportKind.SUPPORTS, ()),
    }
    (cooled,) = operator_support(MODEL, [served("d", [HOT(A)], [], [HOT(A)])])
    assert (cooled.verdict, cooled.absent, cooled.surplus) == (SupportKind.CONTRADICTS, ("+hot(a)",), ("-hot(a)",))


def test_a_label_unlike_those_of_nine_other_demonstrations_is_doubted() -> None:
    demos = [served(f"d{i}", *RIGHT) for i in range(9)]
    wrong = served("wrong", [], [HOT(A)], [DONE(A)])  # it cannot have cooled down: nothing ever does
    (timeline,) = doubted(table([DONE], [HOT], [*demos, wrong]), [HOT])
    (doubt,) = timeline.doubts
    assert (timeline.demo, timeline.atom) == ("wrong", HOT(A))
    assert (doubt.state, doubt.label, doubt.likely) == (2, Label.FALSE, Label.TRUE)
    assert 0.5 < doubt.wrong <= 1 and timeline.expected == doubt.wrong


def test_nothing_is_doubted_where_all_agree_or_nothing_was_asked() -> None:
    right = table([DONE], [HOT], [served(f"d{i}", *RIGHT) for i in range(5)])
    assert doubted(right, [HOT]) == [] and doubted(right, [DONE]) == [] and doubted(right, []) == []


@pytest.mark.parametrize("unusual", [False, True])
def test_a_first_label_unlike_the_others_is_doubted(unusual: bool) -> None:
    demos = [served(f"d{i}", *RIGHT) for i in range(9)]
    early = served("early", [HOT(A)], [HOT(A)], [HOT(A), DONE(A)])
    found = doubted(table([DONE], [HOT], [*demos, early]), [HOT], unusual=unusual)
    assert [(t.demo, [d.state for d in t.doubts]) for t in found] == [("early", [0])]


def test_labels_wrong_all_along_are_doubted_only_when_unusual_ones_are_asked_for() -> None:
    """The course of one atom that never changes is as good as any; the other demonstrations say that it is rare."""
    steady = [[COLD(A)], [COLD(A)], [COLD(A), DONE(A)]]
    demos = [served(f"d{i}", *steady) for i in range(9)]
    never = served("never", *steady)
    never.values[:, never.atoms.index(COLD(A))] = Label.FALSE
    mixed = table([DONE], [COLD], [*demos, never])
    assert doubted(mixed, [COLD]) == []
    (found,) = doubted(mixed, [COLD], unusual=True)
    assert (found.demo, {(d.label, d.likely) for d in found.doubts}) == ("never", {(Label.FALSE, Label.TRUE)})


def with_a_mistake() -> TruthTable:
    demos = [served(f"d{i}", *RIGHT) for i in range(9)]
    return table([DONE], [HOT], [*demos, served("wrong", [], [], [HOT(A), DONE(A)])])


def test_the_label_that_stands_in_the_way_comes_first() -> None:
    mixed = with_a_mistake()
    settings = published(j_threshold=1)
    advice = advise(mixed, settings)
    assert advice.predicates == (HOT,)
    first = advice.labels[0]
    assert (first.demo, first.atom, first.doubt.state, first.doubt.likely) == ("wrong", HOT(A), 1, Label.TRUE)
    document = advice_document(advice)
    assert document["predicates"] == ["hot"]
    row = document["labels"][0]
    assert {k: row[k] for k in ("demo", "atom", "state", "label", "likely")} == {
        "demo": "wrong", "atom": ["hot", "a"], "state": 1, "label": "false", "likely": "true",
    }  # fmt: skip
    corrected = with_labels(mixed, {("wrong", HOT(A), 1): Label.TRUE})
    assert advise(corrected, settings).labels == ()


def test_labels_that_help_only_together_come_before_those_that_do_nothing() -> None:
    """Four of fourteen transitions make a wrong operator, two would be too few to: one fix alone buys nothing."""
    late = [served(f"late{i}", [], [], [HOT(A), DONE(A)]) for i in range(4)]
    single = [served("b0", [HOT(B)], *RIGHT[1:]), served("b1", [], [HOT(A), HOT(B)], [HOT(A), DONE(A)])]
    mixed = table([DONE], [HOT], [*(served(f"d{i}", *RIGHT) for i in range(8)), *late, *single])
    labels = advise(mixed, published(h_data_frac=0.15, j_threshold=1)).labels
    assert {a.demo for a in labels} == {d.name for d in (*late, *single)}
    needed, rest = labels[:2], labels[2:]
    assert {a.demo[:4] for a in needed} == {"late"} and all(abs(a.gain) < 0.1 for a in rest)
    assert needed[0].gain + needed[1].gain > 0 == round(needed[0].gain, 3)


def test_changed_labels_leave_the_table_as_it_was() -> None:
    mixed = with_a_mistake()
    before = [d.values.copy() for d in mixed.demos]
    changed = with_labels(mixed, {("wrong", HOT(A), 1): Label.UNKNOWN})
    assert all(np.array_equal(d.values, v) for d, v in zip(mixed.demos, before, strict=True))
    differing = [
        (d.name, int(s), d.atoms[int(i)], int(d.values[s, i]))
        for d, o in zip(changed.demos, mixed.demos, strict=True)
        for s, i in zip(*np.nonzero(d.values != o.values), strict=True)
    ]
    assert differing == [("wrong", 1, HOT(A), Label.UNKNOWN)]


def test_of_synonyms_the_one_with_fewer_mistakes_is_advised() -> None:
    warm = candidate("warm", BALL)

    def both(d: LabelledDemo) -> LabelledDemo:
        hot = d.atoms.index(HOT(A))
        atoms = (*d.atoms, warm(A))
        return replace(d, atoms=atoms, values=np.column_stack([d.values, d.values[:, hot]]))

    demos = [both(served(f"d{i}", *RIGHT)) for i in range(9)]
    last = both(served("last", *RIGHT))
    last.values[1, last.atoms.index(HOT(A))] = Label.FALSE
    advice = advise(table([DONE], [HOT, warm], [*demos, last]), published(j_threshold=1))
    assert [p.name for p in advice.predicates] == ["warm"]


def test_of_synonyms_the_selected_one_is_advised() -> None:
    """Its labels are those the model is made of, though the other has fewer mistakes."""
    warm = candidate("warm", BALL)
    demos = []
    for i in range(10):
        one = served(f"d{i}", *RIGHT)
        hot = one.values[:, one.atoms.index(HOT(A))].copy()
        demos.append(replace(one, atoms=(*one.atoms, warm(A)), values=np.column_stack([one.values, hot])))
    demos[9].values[1, demos[9].atoms.index(HOT(A))] = Label.FALSE
    source = table([DONE], [HOT, warm], demos)
    for selected in (HOT, warm):
        assert advise(source, published(j_threshold=1), selected=[selected]).predicates == (selected,)


@pytest.mark.parametrize("objects", [(A, C)])
def test_skills_of_other_objects_are_not_read(objects: tuple[Object, ...]) -> None:
    touch = Skill("Touch", (BOX,))
    one = demo("d", objects, [Action(touch, (C,))], [[], [HOT(A)]])
    assert operator_support(MODEL, [one]) == []
