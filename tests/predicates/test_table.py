"""The truth table of demonstrations, and the abstraction of a test state."""

from __future__ import annotations

import numpy as np

from pix2pred.predicates import Abstraction, Labeller, LabelSettings, Occurrence, ground_atoms, label_demos
from pix2pred.structs import Candidate, FromFeatures, FromSkills, FromVLM, Label, Predicate, SkillTrigger, State
from pix2pred.system.progress import Stage
from pix2pred.vlm import Together
from predicates.scripted import COOKED, HOLDING, ITEM, OBJECTS, P1, P2, POOL, ROBOT, UNDER, R, ScriptedVLM, demo, state

ANSWERS = ["cooked(patty1): Unknown. cooked(patty2): True.", "cooked(patty1): True.", "cooked(patty2): False."]
HELD = Predicate("Held", (ITEM,), FromSkills((SkillTrigger("Pick", (1,)),)))
PLAIN = LabelSettings(double_check=False, attempts=1)


def test_unknown_stays_in_the_table_and_is_false_in_abstract_states() -> None:
    labelling = label_demos([demo()], (HOLDING, HELD), POOL, Labeller(ScriptedVLM(ANSWERS), PLAIN))
    (one,) = labelling.table.demos
    column = one.atoms.index(COOKED(P1))
    assert one.values[:, column].tolist() == [Label.UNKNOWN, 1, 1]
    assert [set(s) for s in one.abstract_states()] == [
        {COOKED(P2)}, {COOKED(P1), COOKED(P2), HELD(P1)}, {COOKED(P1), HELD(P1)}
    ]  # fmt: skip
    assert labelling.table.count(Label.UNKNOWN) == 1
    assert labelling.counts[Occurrence.MISSING] == 2 + 3 + 3
    assert [s.text for s in labelling.answers[0]] == ANSWERS


def test_nothing_is_asked_when_no_predicate_needs_it() -> None:
    vlm = ScriptedVLM([])
    labelling = label_demos([demo()], (HOLDING, HELD), (), Labeller(vlm, PLAIN))
    assert vlm.asked == []
    assert labelling.answers == ((),)


def test_threads_change_nothing_and_progress_counts() -> None:
    demos = [demo(actions=i, name=f"d{i}") for i in range(1, 6)]
    seen: list[tuple[Stage, int, int, str]] = []
    tables = [
        label_demos(
            demos, (HOLDING,), POOL,
            Labeller(
                ScriptedVLM(lambda r: f"cooked(patty{len(r.text) % 2 + 1}): True."), LabelSettings(), Together(places)
            ),
            progress=lambda stage, done, total, name: seen.append((stage, done, total, name)),
        ).table
        for places in (1, 4)
    ]  # fmt: skip
    assert tables[0] == tables[1]
    assert seen == [(Stage.LABEL, i, 5, f"d{i}") for i in range(1, 6)] * 2


def test_atoms_are_sorted_typed_and_over_distinct_objects() -> None:
    two = Predicate("Two", (ITEM, ITEM), FromVLM("two"))
    atoms = ground_atoms((two, COOKED), OBJECTS)
    assert list(atoms) == sorted(atoms)
    assert len(atoms) == 3 * 2 + 2
    assert all(len(set(a.objects)) == len(a.objects) for a in atoms)


def test_a_test_state_is_asked_about_the_given_predicates_only() -> None:
    vlm = ScriptedVLM(["cooked(patty1): Unknown. cooked(patty2): True. under(patty1, small_blue_cup): True."])
    seen = State(state(0).pictures, given=frozenset({HOLDING(R, P1), UNDER(P1, OBJECTS[3])}))
    held = Abstraction(OBJECTS, (HOLDING, COOKED, HELD), Labeller(vlm, LabelSettings())).start(seen)
    assert held == {HOLDING(R, P1), COOKED(P2)}
    (request,) = vlm.asked
    assert request.text.endswith("Predicates:\ncooked(patty1)\ncooked(patty2)\n")
    assert "Executed skill" not in request.text


def test_abstraction_without_visual_predicates_asks_nothing() -> None:
    vlm = ScriptedVLM([])
    assert Abstraction(OBJECTS, (HOLDING,), Labeller(vlm, PLAIN)).start(state(0)) == frozenset()


def test_no_demonstrations_give_an_empty_table() -> None:
    assert label_demos([], (HOLDING,), POOL, Labeller(ScriptedVLM([]), PLAIN)).table.demos == ()


def test_an_initial_and_a_proposed_predicate_may_have_the_same_words() -> None:
    initial = Predicate("Holding", (ROBOT, ITEM), FromVLM("holding"))
    proposed = Candidate(Predicate("holding0", (ROBOT, P1.type), FromVLM("holding")), 2.0)
    labeller = Labeller(ScriptedVLM(lambda request: "holding(robot, patty1): True."), PLAIN)
    (one,) = label_demos([demo()], (initial,), (proposed,), labeller).table.demos
    assert one.abstract_states() == (frozenset({initial(R, P1), proposed.predicate(R, P1)}),) * 3


def test_feature_values_are_in_the_table() -> None:
    near = Predicate("near", (), FromFeatures("(forall (<= patty.x 1))"))
    (one,) = label_demos([demo()], (near,), (), Labeller(ScriptedVLM([]), PLAIN)).table.demos
    assert np.array_equal(one.values, [[1], [1], [1]])
