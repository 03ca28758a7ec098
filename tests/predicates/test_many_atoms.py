"""Atoms are counted before they are made: however many there would be, the answer comes at once and says of what."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pix2pred.predicates import ground_atoms
from pix2pred.predicates.labelling.table import TooManyAtomsError, refuse_too_many
from pix2pred.structs import FromVLM, Object, Predicate, Type, count_groundings, groundings

THING = Type("thing")
ITEM, ROBOT = Type("item", (), THING), Type("robot", (), THING)
CUP = Type("cup", (), ITEM)
TYPES = (THING, ITEM, ROBOT, CUP)


def predicate(*types: Type) -> Predicate:
    return Predicate("near0", types, FromVLM("near"))


@pytest.mark.parametrize(
    ("types", "objects", "count"),
    [((ITEM,) * 2, 1100, "1,208,900"), ((ITEM,) * 6, 20, "27,907,200"), ((ITEM,) * 8, 20, "5,079,110,400"),
     ((THING, ITEM, CUP), 1000, "997,002,000")],
)  # fmt: skip
def test_too_many_are_refused_with_the_predicate_and_the_count(
    types: tuple[Type, ...], objects: int, count: str
) -> None:
    things = [Object(f"c{i}", CUP) for i in range(objects)]
    with pytest.raises(TooManyAtomsError, match=rf"near0\(.*\) has {count} of {count} atoms .* raise flow.max_atoms"):
        ground_atoms([predicate(*types)], things)


def test_a_person_can_raise_the_bound() -> None:
    things = [Object(f"c{i}", CUP) for i in range(10)]
    refuse_too_many([predicate(CUP, CUP)], things, 90)
    with pytest.raises(TooManyAtomsError, match="90 of 90 atoms over 10 objects"):
        refuse_too_many([predicate(CUP, CUP)], things, 89)


@given(
    st.lists(st.sampled_from(TYPES), max_size=4), st.lists(st.sampled_from(TYPES), max_size=6), st.booleans()
)  # fmt: skip
def test_tuples_are_counted_exactly(types: list[Type], kinds: list[Type], distinct: bool) -> None:
    objects = [Object(f"o{i}", t) for i, t in enumerate(kinds)]
    assert count_groundings(types, objects, distinct=distinct) == len(
        list(groundings(types, objects, distinct=distinct))
    )
