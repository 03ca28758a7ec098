"""Given predicates that a model labels, as in a project of one's own photos: few demonstrations, wrong labels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from burger_pool import workload
from learning.random_tables import candidate, demo, table
from pix2pred.learning import LearningSettings, hill_climbing, learn_operators
from pix2pred.structs import Action, Atom, FromVLM, LabelledDemo, Object, Operator, Skill, TruthTable, Type

ROBUST = LearningSettings(operators="robust")
ITEM, PLACE, HAND = Type("item"), Type("place"), Type("hand")
PICK, PUT = Skill("Pick", (HAND, ITEM)), Skill("Put", (HAND, ITEM, PLACE))
ON, BARE, HELD = candidate("on", ITEM, PLACE), candidate("bare", PLACE), candidate("held", ITEM)
hand, cup, plate, shelf = Object("hand", HAND), Object("cup", ITEM), Object("plate", PLACE), Object("shelf", PLACE)


def seen(source: TruthTable) -> TruthTable:
    """The same labels, the given predicates being labelled by a model as well."""
    sources = {p: replace(p, source=FromVLM(p.name)) for p in source.initial}

    def told(demo: LabelledDemo) -> LabelledDemo:
        atoms = tuple(Atom(sources.get(a.predicate, a.predicate), a.objects) for a in demo.atoms)
        goal = tuple(Atom(sources[a.predicate], a.objects) for a in demo.goal)
        return LabelledDemo(demo.name, demo.objects, demo.actions, goal, atoms, demo.values)

    return TruthTable(tuple(sources.values()), source.pool, tuple(map(told, source.demos)))


def meant(operators: Sequence[Operator]) -> set[tuple[object, ...]]:
    return {(op.skill, op.preconditions, op.add, op.delete) for op in operators}


@pytest.mark.parametrize("count", [1, 2, 3, 12])
@pytest.mark.parametrize("family", ["more-stacks", "bigger", "combo"])
def test_labels_without_a_mistake_give_what_certain_predicates_give(family: str, count: int) -> None:
    """However few demonstrations there are, also where a skill changes what its arguments do not name (the grill)."""
    source = workload(family, 40, seed=5).table
    few = replace(source, demos=source.demos[-count:])
    certain, found = (hill_climbing(one, ROBUST).run() for one in (few, seen(few)))
    assert found.selected == certain.selected
    assert meant(found.operators) == meant(certain.operators)


def carried(number: int, start: Object = plate, end: Object = shelf) -> LabelledDemo:
    """A cup is picked from one place and put onto another."""
    actions = [Action(PICK, (hand, cup)), Action(PUT, (hand, cup, end))]
    states = [[ON(cup, start), BARE(end)], [HELD(cup), BARE(start), BARE(end)], [ON(cup, end), BARE(start)]]
    return demo(f"d{number}", {hand, cup, plate, shelf}, actions, states, [ON(cup, end)])


def turned(one: LabelledDemo, state: int, atom: Atom) -> LabelledDemo:
    """``one`` with a wrong label."""
    atoms = one.atoms if atom in one.atoms else (*one.atoms, atom)
    values = np.zeros((len(one.values), len(atoms)), one.values.dtype)
    values[:, : len(one.atoms)] = one.values
    values[state, atoms.index(atom)] ^= 1
    return replace(one, atoms=atoms, values=values)


TWICE = [carried(0), carried(1, shelf, plate)]


def learned(demos: Sequence[LabelledDemo]) -> set[tuple[object, ...]]:
    return meant(learn_operators(table([ON, BARE, HELD], [], demos), ROBUST))


def test_what_is_picked_from_is_named_by_no_argument_and_becomes_bare() -> None:
    pick = next(op for op in learn_operators(table([ON, BARE, HELD], [], TWICE), ROBUST) if op.skill == PICK)
    assert [v.type for v in pick.parameters] == [ITEM, HAND, PLACE] and len(pick.skill_args) == 2
    assert {str(a.predicate) for a in pick.add} == {"bare", "held"}
    assert {str(a.predicate) for a in pick.delete} == {"on"}
    assert pick.preconditions >= pick.delete


@pytest.mark.parametrize(
    ("state", "atom"),
    [(0, ON(cup, shelf)), (1, ON(cup, plate)), (1, HELD(cup)), (1, BARE(plate)), (2, BARE(plate)), (2, HELD(cup))],
    ids=str,
)
def test_one_wrong_label_among_four_demonstrations_changes_no_operator(state: int, atom: Atom) -> None:
    demos = [*TWICE, carried(2), carried(3, shelf, plate)]
    assert learned([turned(demos[0], state, atom), *demos[1:]]) == learned(demos)


def test_what_no_label_is_ever_true_of_is_no_obstacle() -> None:
    nowhere = candidate("nowhere", PLACE, PLACE, PLACE)
    found = learn_operators(table([ON, BARE, HELD, nowhere], [], TWICE), ROBUST)
    assert meant(found) == learned(TWICE)
