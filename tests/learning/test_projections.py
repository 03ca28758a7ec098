"""Of two predicates that demonstrations cannot tell apart, the one that determines the other is selected."""

from __future__ import annotations

import pytest

from learning.random_tables import candidate, demo, given, table
from pix2pred.learning import LearningSettings, hill_climbing
from pix2pred.learning.selection.projections import is_projection
from pix2pred.learning.transitions import IndexedTable
from pix2pred.structs import Action, LabelledDemo, Object, Skill, TruthTable, Type

PARCEL, TRUCK, TOWN = Type("parcel"), Type("truck"), Type("town")
LOAD, UNLOAD, DRIVE = Skill("Load", (PARCEL, TRUCK)), Skill("Unload", (PARCEL, TRUCK)), Skill("Drive", (TRUCK, TOWN))
AT, PARKED = given("At", PARCEL, TOWN), given("Parked", TRUCK, TOWN)
IN, LOADED = candidate("in", PARCEL, TRUCK), candidate("a-loaded", PARCEL)
parcel, truck = Object("parcel", PARCEL), Object("truck", TRUCK)
here, there, nowhere = (Object(name, TOWN) for name in ("here", "there", "nowhere"))


def delivery(number: int) -> LabelledDemo:
    """The only truck takes the only parcel to another town."""
    inside = [IN(parcel, truck), LOADED(parcel)]
    states = [
        [AT(parcel, here), PARKED(truck, here)],
        [*inside, PARKED(truck, here)],
        [*inside, PARKED(truck, there)],
        [AT(parcel, there), PARKED(truck, there)],
    ]
    actions = [Action(LOAD, (parcel, truck)), Action(DRIVE, (truck, there)), Action(UNLOAD, (parcel, truck))]
    return demo(f"d{number}", {parcel, truck, here, there, nowhere}, actions, states, [AT(parcel, there)])


def deliveries() -> TruthTable:
    return table([AT, PARKED], [IN, LOADED], [delivery(i) for i in range(6)])


def test_being_loaded_is_a_projection_of_being_in_the_truck() -> None:
    data = IndexedTable(deliveries())
    number = {p: i for i, p in enumerate(data.predicates)}
    assert is_projection(data, number[LOADED], number[IN])
    assert not is_projection(data, number[IN], number[LOADED])
    assert not is_projection(data, number[LOADED], number[AT])


@pytest.mark.parametrize(("operators", "expected"), [("robust", IN), ("cluster-and-intersect", LOADED)])
def test_the_robust_learner_takes_the_one_that_says_more(operators: str, expected: object) -> None:
    settings = LearningSettings.model_validate({"operators": operators, "j_threshold": 10})
    assert hill_climbing(deliveries(), settings).run().selected == (expected,)
