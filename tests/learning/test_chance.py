"""What never changes has to tell more than chance would; of what costs the same, J decides."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import cast

import pytest

from learning.random_tables import candidate, demo, given, table
from pix2pred.learning import LearningSettings
from pix2pred.learning.objective.objective import Objective, Score
from pix2pred.learning.operators.learner import OperatorModel
from pix2pred.learning.selection.candidates import distinct_candidates
from pix2pred.learning.selection.chance import told_by_chance
from pix2pred.learning.selection.explained_effort import ExplainedEffort
from pix2pred.learning.selection.scored_sets import ScoredSets, SearchCounts
from pix2pred.learning.selection.stopping_rule import ScoredSet
from pix2pred.learning.strategies import demo_objective, operator_learner, stopping_rule
from pix2pred.learning.transitions import IndexedTable
from pix2pred.structs import Action, LabelledDemo, Object, Skill, TruthTable, Type
from pix2pred.system.progress import silent

ROBUST = LearningSettings(operators="robust")
CRATE, PLACE = Type("crate"), Type("place")
DROP = Skill("Drop", (CRATE, PLACE))
ON, LARGE, HELD = given("On", CRATE, PLACE), candidate("large", PLACE), candidate("held", CRATE)
crate, shed, yard = Object("crate", CRATE), Object("shed", PLACE), Object("yard", PLACE)

DIVIDING = [i for i in range(16) if i.bit_count() >= 2]
"""Bit sets of the demonstrations, of four, in which a word tells the two places apart: at least two of them."""


def dropping(number: int) -> LabelledDemo:
    """A crate is dropped at the large one of two places."""
    states = [[LARGE(yard), HELD(crate)], [LARGE(yard), ON(crate, yard)]]
    return demo(f"d{number}", {crate, shed, yard}, [Action(DROP, (crate, yard))], states, [ON(crate, yard)])


def droppings(count: int) -> TruthTable:
    return table([ON], [LARGE, HELD], [dropping(i) for i in range(count)])


@pytest.mark.parametrize(("demos", "statics", "expected"), [(3, 9, True), (3, 1, False), (12, 9, False)])
def test_three_large_places_are_an_accident_where_nine_words_could_have_been_it(
    demos: int, statics: int, expected: bool
) -> None:
    data = IndexedTable(droppings(demos))
    model = operator_learner(ROBUST).fit(data)
    large, held = (data.predicates.index(p) for p in (LARGE, HELD))
    classes = model.partition(range(data.initial))
    assert told_by_chance(model, classes, large, statics) is expected
    before = Score(100.0, 0.0, True, ())
    sets = {p: ScoredSet(p, (p,), classes, replace(before, total=50.0)) for p in (large, held)}
    assert ExplainedEffort().by_chance(model, sets[large], before, statics) is expected
    assert not ExplainedEffort().by_chance(model, sets[held], before, statics)  # what changes is refuted by time
    charged = replace(before, total=1100.0, charges=1000.0)  # a back-track less is evidence by itself
    assert not ExplainedEffort().by_chance(model, sets[large], charged, statics)


@pytest.mark.parametrize(("repeats", "expected"), [(1, {"kind-15"}), (3, {f"kind-{i}" for i in DIVIDING})])
def test_accidents_are_not_looked_at(repeats: int, expected: set[str]) -> None:
    """Eleven words hold at every place where a crate was dropped; in four demonstrations only the one that held at no
    other place in any of them is worth a look, in twelve all are."""
    words = {i: candidate(f"kind-{i}", PLACE) for i in DIVIDING}
    demos = []
    for number in range(4 * repeats):
        kinds = [word(yard) for word in words.values()]
        kinds += [word(shed) for i, word in words.items() if not i >> number % 4 & 1]
        states = [[*kinds, HELD(crate)], [*kinds, ON(crate, yard)]]
        demos.append(demo(f"d{number}", {crate, shed, yard}, [Action(DROP, (crate, yard))], states, [ON(crate, yard)]))
    model = operator_learner(ROBUST).fit(IndexedTable(table([ON], [HELD, *words.values()], demos)))
    objective, candidates = Objective(model, demo_objective(ROBUST)), distinct_candidates(model, (), 2)
    sets = ScoredSets(model, stopping_rule(ROBUST), objective, candidates, (), SearchCounts())
    looked_at = {model.data.predicates[s.predicate].name for s in sets.expand(sets.set_of(()), silent)}
    assert looked_at == {"held", *expected}


@dataclass(frozen=True)
class Priced:
    """A model of predicates over nothing, whose labels differ in what they cost."""

    prices: tuple[float, ...]

    @property
    def data(self) -> object:
        return SimpleNamespace(predicates=[SimpleNamespace(types=()) for _ in self.prices])

    def price(self, candidate: int) -> float:
        return self.prices[candidate]

    def doubt(self, candidate: int) -> float:
        return 0.0

    def unexplained(self, classes: object, chosen: tuple[int, ...]) -> float:
        return self.prices[chosen[-1]]


@pytest.mark.parametrize(
    ("prices", "js", "expected"),
    [
        ((1.0, 1.0 + 1e-7), (244.0, 228.0), 1),  # the seventh decimal of an estimate is no reason
        ((1.0, 1.0 + 1e-7), (229.0, 228.0), 0),  # nor is a node
        ((1.0, 1.2), (244.0, 228.0), 0),  # labels that are better are
        ((1.0, 1.0), (300.0, 228.0), 1),
    ],
)
def test_of_candidates_that_cost_the_same_the_one_with_the_smaller_j_is_taken(
    prices: tuple[float, ...], js: tuple[float, ...], expected: int
) -> None:
    sets = [ScoredSet(p, (p,), (), Score(j, 0.0, True, ())) for p, j in enumerate(js)]
    assert ExplainedEffort().choose(cast(OperatorModel, Priced(prices)), sets).predicate == expected


@pytest.mark.parametrize(("exhausted", "expected"), [(frozenset({0}), True), (frozenset[int](), False)])
def test_demonstrations_beyond_the_budget_before_and_after_do_not_hide_what_is_saved(
    exhausted: frozenset[int], expected: bool
) -> None:
    """A hundred thousand nodes were looked at in the first one, and how many more there are nobody knows."""
    before = Score(100_200.0, 0.0, True, (100_000.0, 200.0), frozenset({0}))
    after = Score(100_080.0, 0.0, True, (100_000.0, 80.0), exhausted)
    assert ExplainedEffort().worthwhile(before, after, 0.0) is expected
    assert not ExplainedEffort().worthwhile(before, before, 0.0)
