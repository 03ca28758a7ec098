"""The ablations are the pipeline with a part exchanged: what each keeps, asks and chooses."""

from __future__ import annotations

from itertools import pairwise

import pytest

import burger_truth
from pix2pred.approaches.no_invent import NO_INVENT
from pix2pred.approaches.no_subselect import NO_SUBSELECT, keep_all
from pix2pred.approaches.no_visual import NO_VISUAL
from pix2pred.approaches.ours import OURS
from pix2pred.approaches.vlm_subselect import VLM_SUBSELECT, climb_from_visual
from pix2pred.learning import LearningSettings, learn_operators
from pix2pred.pipeline import LearningProblem
from pix2pred.registry import load_approach
from pix2pred.settings import Settings
from pix2pred.structs import FromVLM, Vocabulary
from pix2pred.structs.formats.names import UnknownNameError
from pix2pred.vlm import Request, VLMError
from predicates.scripted import TYPES, ScriptedVLM, demo

SETTINGS = LearningSettings(operators="cluster-and-intersect", max_plans=20, node_budget=5_000)
TABLE = burger_truth.true_table("more-stacks", {"cooked": "cooked", "hand_free": "hand_empty", "held": "held"})


def nobody(request: Request) -> str:
    raise VLMError("must not be asked")


def test_the_nine_approaches_have_names_and_say_whether_they_need_a_model() -> None:
    needs = {"vlm-subselect", "vlm-feature-predicates", "vila-pure", "vila-fewshot"}
    for name in ("ours", "no-subselect", "no-invent", "no-visual", "no-feature", *needs):
        assert (load_approach(name).name, load_approach(name).needs_model) == (name, name in needs)
    with pytest.raises(UnknownNameError, match="did you mean 'no-visual'"):
        load_approach("no-visul")


def test_keeping_all_learns_operators_over_all() -> None:
    kept = keep_all(TABLE, SETTINGS)
    assert [p.name for p in kept.selected] == ["cooked", "hand_free", "held"]
    assert kept.operators == learn_operators(TABLE, SETTINGS)


def test_the_models_choice_is_given_before_climbing() -> None:
    """All visual predicates are in, though hill climbing on the same table would leave one out."""
    chosen = climb_from_visual(TABLE, SETTINGS)
    assert [p.name for p in chosen.selected] == ["cooked", "hand_free", "held"]
    assert {a.predicate.name for op in chosen.operators for a in op.preconditions} >= {"cooked", "hand_free"}


def test_the_model_is_asked_for_critical_predicates_only() -> None:
    assert VLM_SUBSELECT.adjust(Settings()).proposal.variant == "specific"
    assert OURS.adjust(Settings()) == Settings()


def test_without_visual_predicates_no_model_is_asked() -> None:

    vocabulary = Vocabulary("v", TYPES, (), ())
    for approach in (NO_VISUAL, NO_INVENT):
        pool = approach.pool(LearningProblem(vocabulary, (demo(),), ScriptedVLM(nobody), Settings()))
        assert not any(isinstance(c.predicate.source, FromVLM) for c in pool.candidates)


def test_smaller_pools_are_parts_of_larger_ones() -> None:
    vlm = ScriptedVLM(lambda request: "cooked(patty1), raw(patty1), on(patty1, patty2), near(robot, patty1)")
    names = []
    for size in range(5):
        approach = NO_SUBSELECT.limited(size, seed=3)
        pool = approach.pool(LearningProblem(_vocabulary(), (demo(),), vlm, Settings()))
        names.append({c.predicate.name for c in pool.candidates})
    assert [len(n) for n in names] == [0, 1, 2, 3, 4]
    assert all(a < b for a, b in pairwise(names))


def _vocabulary() -> Vocabulary:

    return Vocabulary("v", TYPES, (), ())
