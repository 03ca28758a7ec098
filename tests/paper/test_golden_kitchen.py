"""With perfect labels Kitchen's two printed operators, and one predicate that says a burner is on (method 12.2)."""

from __future__ import annotations

from functools import cache

import pytest

import golden
import kitchen_truth
from extras import need
from pix2pred.learning import LearningSettings, Selection, hill_climbing, learn_operators
from pix2pred.predicates import GrammarSettings, Labeller, LabelSettings, feature_predicates, label_demos
from pix2pred.structs import Demo, FromFeatures, LiftedAtom, Operator, TruthTable
from pix2pred.vlm.noise.oracle import NoisyOracle

pytestmark = need("mujoco", "gymnasium_robotics", extra="sim")
WORDS = ("burner_on", "has_kettle", "knob_turned", "kettle_on", "gripper_aside")
SETTINGS = LearningSettings(operators="cluster-and-intersect", j_threshold=100)
BURNER_ON = "NOT-[[0:surface].z<=[idx_0]1.59]"


@cache
def labelled() -> tuple[TruthTable, tuple[Demo, ...]]:
    return kitchen_truth.true_table({w: w for w in WORDS})


def shape(op: Operator, rename: str) -> tuple[object, ...]:
    def atoms(group: frozenset[LiftedAtom]) -> frozenset[tuple[str, ...]]:
        return frozenset(
            (BURNER_ON if a.predicate.name == rename else a.predicate.name, *(v.name for v in a.variables))
            for a in group
        )

    parameters = tuple((v.name, v.type.name) for v in op.parameters)
    skill = (op.skill.name, tuple(v.name for v in op.skill_args))
    return op.name, parameters, skill, atoms(op.preconditions), atoms(op.add), atoms(op.delete)


def select(table: TruthTable) -> Selection:
    return hill_climbing(table, SETTINGS).run()


def test_the_two_printed_operators_are_learned_exactly() -> None:
    table, _ = kitchen_truth.true_table({"burner_on": "burner_on"})
    learned = learn_operators(table, LearningSettings(operators="cluster-and-intersect"))
    assert [shape(op, "burner_on") for op in learned] == [shape(op, "") for op in golden.load_operators("kitchen")]
    assert [law for op in learned for law in op.broken_laws()] == []


def test_of_the_visual_words_the_one_that_says_a_burner_is_on_is_selected() -> None:
    selection = select(labelled()[0])
    assert [p.name for p in selection.selected] == ["burner_on"]
    assert [step.j for step in selection.steps] == pytest.approx([3.1e3, 33], rel=0.05)


def test_of_the_features_one_that_says_a_burner_is_on_is_selected() -> None:
    """The printed feature: a burner's plate rises when its knob is turned."""
    _, demos = labelled()
    types = tuple({o.type.name: o.type for o in demos[0].objects}.values())
    pool = feature_predicates(demos, types, GrammarSettings())
    nobody = Labeller(NoisyOracle([], lambda view, word, names: False), LabelSettings())
    table = label_demos(demos, labelled()[0].initial, pool, nobody).table
    selection = select(table)
    (chosen,) = selection.selected
    assert isinstance(chosen.source, FromFeatures)
    assert [shape(op, chosen.name) for op in selection.operators] == [
        shape(op, "") for op in golden.load_operators("kitchen")
    ]
