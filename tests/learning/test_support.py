"""What keeps a climb from over-explaining its demonstrations: evidence for static predicates, and a look back."""

from __future__ import annotations

from pathlib import Path

import pytest

from learning.published import published
from learning.random_tables import BALL, candidate, demo, given, table
from pix2pred.learning import Selection, hill_climbing, load_traces
from pix2pred.learning.objective.objective import Score
from pix2pred.learning.strategies import stopping_rule
from pix2pred.learning.transitions import IndexedTable
from pix2pred.structs import Action, LabelledDemo, Object, Predicate, Skill, TruthTable

LABELS = Path(__file__).parents[1] / "data" / "workloads" / "coffee_reader_seed3.json.gz"
COFFEE = {"h_pre_frac": 0.8, "h_data_frac": 0.05, "j_threshold": 100, "early_stop": "level", "max_plans": 1000}

A, B = Object("a", BALL), Object("b", BALL)
LIT, DONE, BIG = candidate("lit", BALL), given("Done", BALL), candidate("big", BALL)
LIGHT, FINISH = Skill("Light", (BALL,)), Skill("Finish", (BALL,))


def lighting(name: str, big: set[Object], objects: tuple[Object, ...] = (A, B)) -> LabelledDemo:
    """The last object is lit, then done. Those in ``big`` are big throughout."""
    last = objects[-1]
    always = [BIG(o) for o in sorted(big)]
    states = [always, [*always, LIT(last)], [*always, LIT(last), DONE(last)]]
    return demo(name, objects, [Action(LIGHT, (last,)), Action(FINISH, (last,))], states, [DONE(last)])


def lights(*big: set[Object]) -> TruthTable:
    return table([DONE], [LIT, BIG], [lighting(f"d{i}", b) for i, b in enumerate(big)])


def climb(source: TruthTable, **chosen: object) -> Selection:
    return hill_climbing(source, published(**({"j_threshold": 0} | chosen))).run()


def names(predicates: tuple[Predicate, ...]) -> set[str]:
    return {p.name for p in predicates}


def test_demonstrations_that_a_predicate_divides_are_those_where_it_is_true_of_some_objects() -> None:
    alone = lighting("alone", {A}, (A,))
    data = IndexedTable(
        table([DONE], [LIT, BIG], [lighting("one", {B}), lighting("all", {A, B}), lighting("none", set()), alone])
    )
    assert data.demos_divided(data.predicates.index(BIG)) == 1
    assert data.demos_divided(data.predicates.index(LIT)) == 0, "in first states"


@pytest.mark.parametrize(
    ("big", "static_demos", "taken"),
    [([{B}, {B}], 2, True), ([{B}, {A, B}], 2, False), ([{B}, {A, B}], 1, True), ([{B}, {A, B}], 0, True),
     ([{A, B}, {A, B}], 0, False), ([{B}], 2, True)],
)  # fmt: skip
def test_a_static_predicate_needs_demonstrations_in_which_it_tells_objects_apart(
    big: list[set[Object]], static_demos: int, taken: bool
) -> None:
    """Knowing that only big balls are lit saves nodes. One demonstration alone is all the evidence there can be."""
    found = climb(lights(*big), static_demos=static_demos)
    assert "lit" in names(found.selected)
    assert ("big" in names(found.selected)) == taken


def test_a_pinned_static_predicate_is_taken_at_once() -> None:
    source = lights({B}, {A, B})
    assert names(hill_climbing(source, published(j_threshold=0), pinned=[BIG]).run().selected) >= {"big"}


def score(total: float) -> Score:
    return Score(total, 0.0, True, (total,))


@pytest.mark.parametrize(
    ("early_stop", "fewer", "reached", "as_good"),
    [("level", 99.0, 60.0, True), ("level", 101.0, 60.0, False), ("level", 300.0, 300.0, True),
     ("level", 301.0, 300.0, False), ("improvement", 399.0, 300.0, True), ("improvement", 401.0, 300.0, False)],
)  # fmt: skip
def test_a_predicate_is_superfluous_when_the_early_stop_would_not_have_asked_for_it(
    early_stop: str, fewer: float, reached: float, as_good: bool
) -> None:
    rule = stopping_rule(published(early_stop=early_stop, j_threshold=100, superseded="drop"))
    assert rule.looks_back
    assert rule.as_good(score(fewer), score(reached)) == as_good


HEAT, WASH, SERVE = (Skill(n, (BALL,)) for n in ("Heat", "Wash", "Serve"))


@pytest.mark.parametrize(
    ("superseded", "selected"), [("drop", {"washed", "heated"}), ("keep", {"hot", "washed", "heated"})]
)
def test_what_later_predicates_made_superfluous_is_dropped(superseded: str, selected: set[str]) -> None:
    """``hot`` is taken first; ``heated`` ends with washing, so that heating twice leads nowhere, and says all of it."""
    truth = {"hot": [0, 1, 1, 1], "washed": [0, 0, 1, 1], "heated": [0, 1, 0, 0]}
    demos = []
    for i, heated_at_the_end in enumerate((0, 0, 1)):
        truth["heated"][3] = heated_at_the_end
        states = [
            [candidate(n, BALL)(A) for n, held in truth.items() if held[t]] + [DONE(A)] * (t == 3) for t in range(4)
        ]
        demos.append(demo(f"d{i}", [A], [Action(s, (A,)) for s in (HEAT, WASH, SERVE)], states, [DONE(A)]))
    source = table([DONE], [candidate(n, BALL) for n in truth], demos)
    found = climb(source, superseded=superseded)
    assert names(found.selected) == selected
    assert [s.added.name for s in found.steps if s.added] == ["hot", "washed", "heated"]
    assert names(found.dropped) == {"hot", "washed", "heated"} - selected


def test_labels_of_the_coffee_reader_with_one_demonstration_of_two_cups() -> None:
    """A distractor is taken first here, and a cup's size tells the only two cups apart that were ever seen together."""
    found = climb(load_traces(LABELS).table, **COFFEE)
    assert names(found.selected) == {"contains_coffee0", "occupied0", "handle_turned_away0"}
