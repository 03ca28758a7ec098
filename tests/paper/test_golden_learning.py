"""With perfect labels the printed operators, the order of selection and its stopping step (method 12.2)."""

from __future__ import annotations

import re

import pytest

import burger_truth
import golden
from pix2pred.learning import LearningSettings, hill_climbing, learn_operators
from pix2pred.structs import LiftedAtom, Operator, TruthTable

WORDS = {"cooked": "cooked", "hand_free": "hand_empty", "chopped": "chopped"}
PRINTED = {"more-stacks": "more_burger_stacks", "bigger": "bigger_burger", "combo": "combo_burger"}
NEEDED = {"more-stacks": ["cooked", "hand_free"], "bigger": ["cooked", "hand_free"],
          "combo": ["chopped", "hand_free", "cooked"]}  # fmt: skip
HAND_FREE = ("empty_hands", "[[0:robot].fingers<=[idx_0]0.5]", "clear5")
J_TABLE = {"more-stacks": [1.1e5, 11.6e3, 280], "bigger": [8.0e5, 10.1e3, 476], "combo": [3.1e5, 10.2e3, 3.7e3, 378]}


def _table(family: str, words: list[str]) -> TruthTable:
    return burger_truth.true_table(family, {w: WORDS[w] for w in words})


def _word(name: str) -> str:
    """The printed name without the number that keeps signatures apart; every printed hand-free is one word."""
    if name in HAND_FREE:
        return "hand_free"
    base = re.sub(r"\d+$", "", name)
    return "hand_free" if base in HAND_FREE else base


def _shape(op: Operator) -> tuple[object, ...]:
    def atoms(group: frozenset[LiftedAtom]) -> frozenset[tuple[str, ...]]:
        return frozenset((_word(a.predicate.name), *(v.name for v in a.variables)) for a in group)

    parameters = tuple((v.name, v.type.name) for v in op.parameters)
    skill = (op.skill.name, tuple(v.name for v in op.skill_args))
    return op.name, parameters, skill, atoms(op.preconditions), atoms(op.add), atoms(op.delete)


@pytest.mark.parametrize("family", PRINTED)
def test_the_printed_operators_are_learned_exactly(family: str) -> None:
    learned = learn_operators(_table(family, NEEDED[family]), LearningSettings(operators="cluster-and-intersect"))
    expected = golden.load_operators(PRINTED[family])
    assert [_shape(op) for op in learned] == [_shape(op) for op in expected]
    assert [law for op in learned for law in op.broken_laws()] == []


@pytest.mark.parametrize("engine", ["grouped", "exact-tree"])
@pytest.mark.parametrize("early_stop", ["level", "improvement"])
@pytest.mark.parametrize("family", PRINTED)
def test_selection_follows_the_table(family: str, early_stop: str, engine: str) -> None:
    settings = LearningSettings.model_validate(
        {"operators": "cluster-and-intersect", "engine": engine, "early_stop": early_stop}
    )
    selection = hill_climbing(_table(family, list(WORDS)), settings).run()
    assert [step.added.name for step in selection.steps if step.added] == NEEDED[family]
    for step, expected in zip(selection.steps, J_TABLE[family], strict=True):
        assert step.j == pytest.approx(expected, rel=0.35)
    assert selection.budget_hits == 0
