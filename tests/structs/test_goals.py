"""Goals with ``not``, ``and`` and ``or``: how they are read, and opposites in states and operators."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pix2pred.structs import (
    Application,
    Atom,
    FromHuman,
    LiftedAtom,
    Object,
    Operator,
    Predicate,
    Skill,
    Type,
    Variable,
)
from pix2pred.structs.goals.opposites import as_learned, changing_denials, contrary, denied_in, is_denial, with_denials
from pix2pred.structs.goals.words import parse_goal, parse_goals, shown

CUP = Type("cup")
A, B = Object("a", CUP), Object("b", CUP)
FULL, WET = Predicate("Full", (CUP,), FromHuman()), Predicate("Wet", (CUP,), FromHuman())
NAMES = {"Full": FULL, "Wet": WET}


def atom(written: Application) -> Atom:
    if written.name not in NAMES:
        raise ValueError(f"predicate {written.name!r} is not declared")
    return Atom(NAMES[written.name], tuple({"a": A, "b": B}[name] for name in written.args))


def goals(*texts: str) -> list[list[str]]:
    return [[str(a) for a in goal] for goal in parse_goals(texts, atom)]


def test_texts_are_conjunctions_and_or_gives_alternatives() -> None:
    assert goals("Full(a)", "Wet(b)") == [["Full(a)", "Wet(b)"]]
    assert goals("Full(a) or Full(b)", "not Wet(a)") == [["Full(a)", "not Wet(a)"], ["Full(b)", "not Wet(a)"]]
    assert goals("Full(a) and Wet(a) or Full(b)") == [["Full(a)", "Wet(a)"], ["Full(b)"]], "'or' binds least"
    assert goals("not (Full(a) or Wet(a))") == [["not Full(a)", "not Wet(a)"]]
    assert goals("not(Full(a) and not Wet(a))") == [["not Full(a)"], ["Wet(a)"]]
    assert goals("! Full( a )", "not not Wet(a)") == [["not Full(a)", "Wet(a)"]]
    assert goals() == [[]]


def test_what_contradicts_itself_is_left_out_and_what_cannot_be_is_refused() -> None:
    assert goals("Full(a) or Wet(a)", "not Full(a)") == [["Wet(a)", "not Full(a)"]]
    with pytest.raises(ValueError, match="the goal can never hold"):
        goals("Full(a)", "not Full(a)")


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("Full(a) or", r"expected an atom such as On\(a, b\), 'not' or '\(' at the end of 'Full\(a\) or'"),
        ("Full(a) Wet(a)", r"expected 'and' or 'or' in place of 'Wet\(a\)' at character"),
        ("(Full(a)", r"expected '\)' at the end"),
        ("Full(a))", r"expected 'and' or 'or' in place of '\)'"),
        ("not", r"expected an atom .* at the end"),
        ("and Full(a)", r"expected an atom .* in place of 'and'"),
        ("Full a", r"expected Name\(object, \.\.\.\), found 'Full a'"),
        ("not Full", r"expected Name\(object, \.\.\.\), found"),
        ("not Dry(a)", "predicate 'Dry' is not declared"),
    ],
)
def test_errors_say_where(text: str, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        parse_goals([text], atom)


def test_too_many_alternatives_are_refused() -> None:
    either = "(Full(a) or Wet(a))"
    with pytest.raises(ValueError, match="more than 16 ways"):
        parse_goals([f"{either} and {either} and (Full(b) or Wet(b)) or not {either}"] * 3, atom)
    with pytest.raises(ValueError, match="more than 16 ways"):
        parse_goal(" and ".join([either] * 12))


@given(st.lists(st.sampled_from(["Full(a)", "Wet(a)", "not Full(b)", "Wet(a) or Full(b)"]), min_size=1, max_size=3))
def test_what_is_shown_is_read_again(texts: list[str]) -> None:
    found = parse_goals(texts, atom)
    assert parse_goals(shown(found), atom) == found


def test_an_opposite_holds_where_its_atom_does_not() -> None:
    dry = contrary(Atom(WET, (A,)))
    assert (str(dry), contrary(dry), is_denial(dry), is_denial(contrary(dry))) == ("not Wet(a)", WET(A), True, False)
    assert denied_in([dry, FULL(A)]) == {WET}
    state = with_denials(frozenset([WET(A), FULL(B)]), [WET], [A, B])
    assert sorted(map(str, state)) == ["Full(b)", "Wet(a)", "not Wet(b)"]


def test_operators_keep_opposites_up_to_date() -> None:
    x = Variable("?x", CUP)
    wet, full = LiftedAtom(WET, (x,)), LiftedAtom(FULL, (x,))
    dry = Operator("Dry", (x,), frozenset([wet]), frozenset([full]), frozenset([wet]), Skill("Dry", (CUP,)), (x,))
    (changed,) = changing_denials((dry,), frozenset([WET, FULL]))
    step = changed.ground((A,))
    before = with_denials(frozenset([WET(A)]), [WET, FULL], [A])
    assert step.apply(before) == with_denials(dry.ground((A,)).apply(frozenset([WET(A)])), [WET, FULL], [A])
    assert as_learned(step, (dry,)) == dry.ground((A,))
    assert changing_denials((dry,), frozenset()) == (dry,)
