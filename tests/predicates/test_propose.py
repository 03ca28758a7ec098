"""Proposals: filters with reasons, retries, and the pool."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pix2pred.predicates import EmptyProposalError, Proposal, ProposalSettings, ProposedAtom, lift, propose
from pix2pred.predicates.proposing.propose import read_proposal
from pix2pred.structs import FromVLM, Object, Type
from pix2pred.vlm import Together
from predicates.scripted import BLUE_CUP, CUP, ITEM, OBJECTS, P1, P2, PATTY, ScriptedVLM, demo

DIVERSE = ProposalSettings()


def read(text: str, settings: ProposalSettings = DIVERSE) -> Proposal:
    return read_proposal(demo(), text, settings)


def accepted(proposal: Proposal) -> list[str]:
    return [f"{a.name}({', '.join(o.name for o in a.objects)})" for a in proposal.accepted]


def reasons(proposal: Proposal) -> dict[str, str]:
    return {r.text: r.reason for r in proposal.rejected}


def test_atoms_over_the_objects_are_accepted_in_order_and_once() -> None:
    text = "Before: raw(patty1)\nAfter: **under(patty1, small_blue_cup)**, raw(patty1)\nraw( patty1 ) raw(p2)"
    assert accepted(read(text)) == ["raw(p1)", "under(p1, c)", "raw(p2)"]


def test_every_filter_gives_its_reason() -> None:
    settings = ProposalSettings(exclude=("hand", "Gripper"), max_atoms=1)
    found = read("raw(patty1) raw(x) in_HAND(p1) near(gripper, p1) on(p1, p1) raw(p2) raw(patty1)", settings)
    assert accepted(found) == ["raw(p1)"]
    assert reasons(found) == {
        "raw(x)": "x is not an object of this demonstration",
        "in_HAND(p1)": "mentions the excluded word hand",
        "near(gripper, p1)": "gripper is not an object of this demonstration",
        "on(p1, p1)": "names one object twice",
        "raw(p2)": "over the limit of 1 atoms",
    }


def test_an_unknown_object_comes_before_every_other_reason() -> None:
    settings = ProposalSettings(exclude=("hand",), max_atoms=1)
    assert reasons(read("hand(x, x) a(p1) hand(p1, p1)", settings)) == {
        "hand(x, x)": "x is not an object of this demonstration",
        "hand(p1, p1)": "mentions the excluded word hand",
    }


@pytest.mark.parametrize(("places", "cups", "taken"), [(2, 60, True), (3, 12, True), (3, 13, False), (6, 4, False)])
def test_predicates_of_many_places_and_objects_are_rejected_with_the_count(places: int, cups: int, taken: bool) -> None:
    cup = Type("cup")
    names = [f"cup{i}" for i in range(cups)] + [f"lid{i}" for i in range(6 - min(cups, 6))]
    scene = replace(demo(), objects=tuple(Object(name, cup) for name in names))
    found = read_proposal(scene, f"tower({', '.join(names[:places])})", DIVERSE)
    assert bool(found.accepted) == taken
    if not taken:
        assert f"{places} places, which makes {len(names) ** places:,} atoms" in found.rejected[0].reason


def test_the_same_name_may_have_several_arities() -> None:
    assert accepted(read("on(p1) on(p1, c)")) == ["on(p1)", "on(p1, c)"]


@given(st.text(alphabet=st.sampled_from("on(p12,c) \n*\\_"), max_size=80))
def test_whatever_is_answered_only_known_objects_get_in(text: str) -> None:
    found = read(text, ProposalSettings(max_atoms=2))
    assert len(found.accepted) <= 2
    assert all(o in OBJECTS for a in found.accepted for o in a.objects)
    assert all(r.reason for r in found.rejected)


def test_an_unusable_answer_is_asked_again() -> None:
    vlm = ScriptedVLM(["I can't help with that.", "raw(nothing)", "raw(p1)"])
    (proposal,) = propose([demo()], vlm, DIVERSE, together=Together(1))
    assert accepted(proposal) == ["raw(p1)"]
    assert [r.attempt for r in vlm.asked] == [0, 1, 2]
    assert len({r.key("m") for r in vlm.asked}) == 3
    assert {r.temperature for r in vlm.asked} == {0.0}


def test_a_demonstration_without_atoms_is_no_error_unless_all_are() -> None:
    one = propose(
        [demo(name="a"), demo(name="b")],
        ScriptedVLM(["raw(p1)", "", ""]),
        ProposalSettings(attempts=2),
        together=Together(1),
    )
    assert [len(p.accepted) for p in one] == [1, 0]
    with pytest.raises(EmptyProposalError, match="scripted proposed no usable predicate for any of 2"):
        propose([demo(), demo()], ScriptedVLM(lambda request: "raw(x)"), DIVERSE)


def test_proposals_are_in_the_order_of_the_demonstrations_with_many_threads() -> None:
    demos = [demo(actions=i, name=f"d{i}") for i in range(6)]
    vlm = ScriptedVLM(lambda request: f"n{len(request.views)}(p1)")
    found = propose(demos, vlm, DIVERSE, together=Together(4))
    assert [p.demo for p in found] == [d.name for d in demos]
    assert [accepted(p) for p in found] == [[f"n{i + 1}(p1)"] for i in range(6)]


def test_every_state_and_camera_is_shown_under_its_heading() -> None:
    vlm = ScriptedVLM(["raw(p1)"])
    propose([demo(cameras=("left", "right"))], vlm, ProposalSettings(marks=False), together=Together(1))
    views = vlm.asked[0].views
    assert [v.heading for v in views] == [f"state {t}, camera {c}" for t in range(3) for c in ("left", "right")]
    assert not any(v.marks for v in views)
    assert set(views[0].boxes) == {"robot", "patty1", "patty2", "small_blue_cup"}


def proposed(*atoms: tuple[str, tuple[Object, ...]]) -> Proposal:
    return Proposal("d", tuple(ProposedAtom(name, objects) for name, objects in atoms), ())


def names(*atoms: tuple[str, tuple[Object, ...]], taken: tuple[str, ...] = ()) -> dict[str, tuple[Type, ...]]:
    return {c.predicate.name: c.predicate.types for c in lift([proposed(*atoms)], taken)}


def test_lifting_numbers_signatures_by_their_sorted_type_names() -> None:
    found = names(("on", (P1, BLUE_CUP)), ("on", (P2,)), ("on", (BLUE_CUP, P1)), ("on", (P1,)), ("hot", (P2,)))
    assert found == {"hot0": (PATTY,), "on0": (CUP, PATTY), "on1": (PATTY,), "on2": (PATTY, CUP)}


def test_lifting_keeps_the_most_specific_types_and_the_words_of_the_query() -> None:
    (candidate,) = lift([proposed(("on", (P1,))), proposed(("on", (P2,)))])
    assert candidate.predicate.types == (PATTY,) != (ITEM,)
    assert candidate.predicate.source == FromVLM("on")
    assert candidate.cost == 1.0
    assert lift([proposed(("on", (P1, BLUE_CUP)))])[0].cost == 2.0


def test_names_in_use_are_left_alone() -> None:
    assert names(("on", (P1,)), taken=("on0",)) == {"on_0": (PATTY,)}
    assert names(("on", (P1,)), taken=("on0", "on_0")) == {"on_0_": (PATTY,)}
    many = names(("on", (P1,)), ("on", (BLUE_CUP,)), ("on_", (P1,)), taken=("on0",))
    assert len(many) == 3


@given(st.lists(st.tuples(st.sampled_from(["a", "a1", "a10", "a_"]), st.permutations(OBJECTS)), max_size=12))
def test_names_are_unique_and_do_not_depend_on_the_order(atoms: list[tuple[str, list[Object]]]) -> None:
    short = [(name, tuple(objects[:2])) for name, objects in atoms]
    pool = lift([proposed(*short)], taken=("a0", "a10", "a_0"))
    assert pool == lift([proposed(*reversed(short))], taken=("a0", "a10", "a_0"))
    assert len({c.predicate.name for c in pool} | {"a0", "a10", "a_0"}) == len(pool) + 3
    assert list(pool) == sorted(pool)
    assert {(c.predicate.source, c.predicate.types) for c in pool} == {
        (FromVLM(name), tuple(o.type for o in objects)) for name, objects in short
    }
