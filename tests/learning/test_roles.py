"""Effects on objects that neither a skill nor the given effects mention."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import cast

import pytest

import coffee_truth
from learning.random_tables import candidate, demo, given, table
from pix2pred.learning import LearningSettings, hill_climbing, learn_operators
from pix2pred.learning.objective.objective import Score
from pix2pred.learning.operators.learner import OperatorModel
from pix2pred.learning.selection.explained_effort import ExplainedEffort, ExplainedEffortSettings
from pix2pred.learning.selection.hill_climbing import HillClimbing
from pix2pred.learning.selection.stopping_rule import ScoredSet
from pix2pred.learning.strategies import demo_objective, operator_learner
from pix2pred.structs import Action, LabelledDemo, Object, Operator, Skill, TruthTable, Type

ROBUST = LearningSettings(operators="robust")
MACHINE, JUG = Type("machine"), Type("jug")
PRESS, FETCH = Skill("Press", (MACHINE,)), Skill("Fetch", (JUG,))
PRESSED, FETCHED, FULL, UNDER = (
    given("Pressed", MACHINE),
    given("Fetched", JUG),
    candidate("full", JUG),
    candidate("under", JUG),
)
machine, jug, spare = Object("machine", MACHINE), Object("jug", JUG), Object("spare", JUG)


def pressing(number: int, *, seen: bool = True, jugs: tuple[Object, ...] = (jug,)) -> LabelledDemo:
    """A machine is pressed, which fills the jug under it; then the jug is fetched. Not ``seen``: the label is wrong."""
    actions = [Action(PRESS, (machine,)), Action(FETCH, (jug,))]
    under = [UNDER(jug)]
    pressed = [*under, PRESSED(machine)]
    states = [under, [*pressed, *([FULL(jug)] if seen else [])], [*pressed, FULL(jug), FETCHED(jug)]]
    return demo(f"d{number}", {machine, *jugs}, actions, states, [FETCHED(jug)])


def press(demos: list[LabelledDemo]) -> Operator:
    """What pressing is taken to do."""
    found = learn_operators(table([PRESSED, FETCHED], [FULL, UNDER], demos), ROBUST)
    return next(op for op in found if op.skill == PRESS)


def test_pressing_fills_the_only_jug_although_no_argument_names_it() -> None:
    operator = press([pressing(i, seen=i != 3) for i in range(8)])
    assert [v.type for v in operator.parameters] == [MACHINE, JUG] and len(operator.skill_args) == 1
    (effect,) = (a for a in operator.add if a.predicate == FULL)
    assert effect.variables == (operator.parameters[1],)
    assert {a.predicate for a in operator.preconditions} == {UNDER}


def test_one_jug_of_several_cannot_be_named() -> None:
    operator = press([pressing(i, jugs=(jug, spare)) for i in range(8)])
    assert [v.type for v in operator.parameters] == [MACHINE]


def test_what_changes_now_and_then_is_no_effect_of_the_skill() -> None:
    operator = press([pressing(i, seen=i % 2 == 0) for i in range(8)])
    assert FULL not in {a.predicate for a in operator.add}


def coffee() -> TruthTable:
    """Coffee in the offline reader's words, without errors; the cheapest is the opposite of a given predicate."""
    words = {"contains_coffee": "jug_has_coffee", "inside": "jug_in_machine", "away": "handle_reachable"}
    true = coffee_truth.true_table(words)
    demos = []
    for one in true.demos:
        values = one.values.copy()
        for i, atom in enumerate(one.atoms):
            if atom.predicate.name == "away":
                values[:, i] = 1 - values[:, i]
        demos.append(replace(one, values=values))
    pool = tuple(replace(c, cost=0.5) if c.predicate.name == "away" else c for c in true.pool)
    return TruthTable(true.initial, pool, tuple(demos))


def test_two_predicates_that_pay_only_together_are_found_behind_one_that_turns_out_superfluous() -> None:
    """Turning the machine on fills a jug that is none of its arguments."""
    selection = hill_climbing(coffee(), ROBUST).run()
    assert [step.added and step.added.name for step in selection.steps] == [None, "away", "contains_coffee", "inside"]
    j = [step.j for step in selection.steps]
    assert 5000 < j[2] < j[1] < 5500 and j[3] < 200  # a back-track less in each of five demonstrations
    assert {p.name for p in selection.selected} == {"contains_coffee", "inside"}
    assert [p.name for p in selection.dropped] == ["away"]
    turn = next(op for op in selection.operators if op.skill.name == "TurnMachineOnAndFill")
    assert any(str(a).startswith("contains_coffee") for a in turn.add)


@pytest.mark.parametrize(("pairs", "expected"), [(0, {"away"}), (1, {"contains_coffee", "inside"})])
def test_two_predicates_that_pay_only_together_are_found_behind_each_other(pairs: int, expected: set[str]) -> None:
    """No candidate is taken on trial, so that after the first one none pays by itself."""
    settings = ExplainedEffortSettings(trials=0, pairs=pairs, restarts=0)
    learner, objective = operator_learner(ROBUST), demo_objective(ROBUST)
    selection = HillClimbing(learner, objective, ExplainedEffort(settings), 2).fit(coffee())
    assert {p.name for p in selection.selected} == expected


@pytest.mark.parametrize(("restarts", "expected"), [(0, {"away"}), (1, {"contains_coffee", "inside"})])
def test_a_climb_that_ends_with_charges_is_tried_again_without_its_first_choice(
    restarts: int, expected: set[str]
) -> None:
    settings = ExplainedEffortSettings(trials=0, pairs=0, restarts=restarts)
    learner, objective = operator_learner(ROBUST), demo_objective(ROBUST)
    selection = HillClimbing(learner, objective, ExplainedEffort(settings), 2).fit(coffee())
    assert {p.name for p in selection.selected} == expected


@dataclass(frozen=True)
class Doubting:
    """A model of which the first predicate's labels are doubtful: one in ten is not accounted for."""

    def doubt(self, candidate: int) -> float:
        return 0.1 if candidate == 0 else 0.0


@pytest.mark.parametrize(("j", "expected"), [(150.0, True), (199.0, True), (201.0, False)])
def test_a_doubtful_predicate_is_exchanged_for_one_that_serves_nearly_as_well(j: float, expected: bool) -> None:
    """Where the robot stands may tell in two demonstrations what its hand does, but not always, and save more nodes."""
    model = cast(OperatorModel, Doubting())
    old, new = (ScoredSet(p, (p,), (), Score(total, 0.0, True, ())) for p, total in ((0, 100.0), (1, j)))
    assert ExplainedEffort().doubtful(model, [0, 1]) == [0]
    assert ExplainedEffort().replaces(model, new, old, 0) is expected
    costly = replace(new, score=replace(new.score, charges=1000.0))
    assert not ExplainedEffort().replaces(model, costly, old, 0)
