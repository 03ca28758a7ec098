"""The feature grammar: the table of 4.1, the wrappers of 4.2, limits, pruning, names."""

from __future__ import annotations

from itertools import islice, pairwise

import pytest

from pix2pred.predicates import GrammarSettings, feature_predicates
from pix2pred.predicates.grammar import dyadic_constants
from pix2pred.structs import Action, Demo, FromFeatures, Object, Skill, State, Type

ROBOT = Type("robot", ("fingers", "still"))
CUP = Type("cup", ("z",))
ARM, CUP0, CUP1 = Object("arm", ROBOT), Object("cup0", CUP), Object("cup1", CUP)
WAIT = Action(Skill("Wait", ()), ())


def demo(*rows: tuple[float, float, float]) -> Demo:
    """One state for each (fingers, z of cup0, z of cup1)."""
    states = tuple(State((), {ARM: (fingers, 7.0), CUP0: (z0,), CUP1: (z1,)}) for fingers, z0, z1 in rows)
    return Demo("d", (ARM, CUP0, CUP1), states, (WAIT,) * (len(rows) - 1), ())


def found(*demos: Demo, **limits: float) -> list[tuple[str, float]]:
    settings = GrammarSettings.model_validate(limits)
    return [(c.predicate.name, c.cost) for c in feature_predicates(demos, (ROBOT, CUP), settings)]


def test_the_table_of_constants() -> None:
    first = list(islice(dyadic_constants(), 15))
    assert [c for c, _ in first] == [
        0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875, 0.0625, 0.5625, 0.3125, 0.8125, 0.1875, 0.6875, 0.4375, 0.9375
    ]  # fmt: skip
    assert [cost for _, cost in first] == [1, 2, 2, 3, 3, 3, 3] + [4] * 8


def test_constants_never_repeat_and_costs_never_fall() -> None:
    many = list(islice(dyadic_constants(), 2**10 - 1))
    assert sorted(c for c, _ in many) == [i / 2**10 for i in range(1, 2**10)]
    assert all(a[1] <= b[1] for a, b in pairwise(many))


def test_names_costs_and_order_of_the_wrappers() -> None:
    leaf = "[[0:cup].z<=[idx_0]0.5]"
    assert found(demo((0, 0, 1), (0, 0, 0), (0, 1, 1)), max_candidates=6) == [
        (leaf, 2),
        (f"Forall[0:cup].[{leaf}[0]]", 3),
        (f"NOT-Forall[0:cup].[{leaf}[0]]", 3),
        (f"NOT-{leaf}", 2),
        (f"Forall[0:cup].[NOT-{leaf}[0]]", 3),
        (f"NOT-Forall[0:cup].[NOT-{leaf}[0]]", 3),
    ]


def test_types_by_name_then_features_in_order() -> None:
    names = [name for name, _ in found(demo((0, 0, 1), (1, 0, 1)))]
    assert names.index("[[0:cup].z<=[idx_0]0.5]") < names.index("[[0:robot].fingers<=[idx_0]0.5]")
    assert not any("still" in name for name in names), "a feature that never changes is left out"


def test_predicates_of_equal_truth_are_kept_once() -> None:
    names = [name for name, _ in found(demo((0, 0, 1), (0, 0, 1)))]
    assert names == ["[[0:cup].z<=[idx_0]0.5]", "Forall[0:cup].[[[0:cup].z<=[idx_0]0.5][0]]",
                     "NOT-Forall[0:cup].[[[0:cup].z<=[idx_0]0.5][0]]", "NOT-[[0:cup].z<=[idx_0]0.5]"]  # fmt: skip


def test_a_finer_constant_is_kept_when_it_tells_more_apart() -> None:
    names = [name for name, _ in found(demo((0, 0, 0.7), (0, 0, 1)))]
    assert "[[0:cup].z<=[idx_2]0.75]" in names
    assert not any("idx_1]" in name for name in names)


@pytest.mark.parametrize(("max_cost", "count"), [(2, 0), (2.5, 1), (3, 1), (3.5, 6)])
def test_the_first_item_over_the_cost_limit_ends_the_enumeration(max_cost: float, count: int) -> None:
    data = demo((0, 0, 1), (0, 0, 0), (0, 1, 1))
    assert len(found(data, max_cost=max_cost)) == count


@pytest.mark.parametrize("count", [0, 1, 4])
def test_the_limit_of_candidates(count: int) -> None:
    assert len(found(demo((0, 0, 1), (0, 0, 0), (0, 1, 1)), max_candidates=count)) == count


def test_ranges_are_over_all_demonstrations() -> None:
    assert found(demo((0, 0, 1)), demo((0, 3, 3)), max_candidates=1)[0][0] == "[[0:cup].z<=[idx_0]1.5]"


def test_without_features_the_grammar_is_empty() -> None:
    assert found(Demo("d", (ARM,), (State(),), (), ())) == []
    assert found() == []
    assert found(demo((0, 1, 1), (0, 1, 1 + 1e-7))) == [], "nothing varies"


def test_sources_hold_the_exact_number() -> None:
    candidates = feature_predicates([demo((0, 0, 1 / 3), (0, 0, 0))], (ROBOT, CUP), GrammarSettings())
    assert candidates[0].predicate.source == FromFeatures(f"(<= cup.z {0.5 * (1 / 3)!r})")
    assert candidates[0].predicate.types == (CUP,)
    assert candidates[1].predicate.types == ()


def test_objects_of_a_subtype_without_the_feature() -> None:
    thing = Type("thing", ("z",))
    mug = Type("mug", (), thing)
    a, b, c = Object("a", thing), Object("b", thing), Object("c", mug)
    data = Demo("d", (a, b, c), (State((), {a: (0.0,), b: (1.0,), c: ()}),), (), ())
    assert feature_predicates([data], (thing, mug), GrammarSettings())
