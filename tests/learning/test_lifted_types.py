"""Variables have the types that skills declare, unless what skills do tells the types below apart."""

from __future__ import annotations

import numpy as np
import pytest

from pix2pred.learning import LearningSettings, learn_operators
from pix2pred.learning.operators.shared_words import with_shared_words
from pix2pred.learning.operators.sharing import sharing
from pix2pred.structs import (
    Action,
    Atom,
    Candidate,
    FromDomain,
    FromVLM,
    Label,
    LabelledDemo,
    Object,
    Operator,
    Predicate,
    Skill,
    TruthTable,
    Type,
)

HAND, ITEM = Type("hand"), Type("item")
BAG, ICE, PLATE = Type("bag", (), ITEM), Type("ice", (), ITEM), Type("plate")
THE_HAND, THE_BAG, THE_ICE, THE_PLATE = Object("hand", HAND), Object("bag", BAG), Object("ice", ICE), Object("p", PLATE)
PICK = Skill("Pick", (HAND, ITEM))
HELD = Predicate("Held", (ITEM,), FromDomain())
WET = Predicate("wet0", (HAND,), FromVLM("wet"))
MELTED = Predicate("melted0", (ICE,), FromVLM("melted"))
BAG_HELD, ICE_HELD = Predicate("held0", (BAG,), FromVLM("held")), Predicate("held1", (ICE,), FromVLM("held"))


def demo(name: str, item: Object, after: list[Atom], unknown: list[Atom] | None = None) -> LabelledDemo:
    """One Pick of ``item``, after which the atoms in ``after`` hold and those in ``unknown`` cannot be seen."""
    atoms = tuple(sorted({*after, *(unknown or ())}))
    values = np.zeros((2, len(atoms)), dtype=np.int8)
    values[1, [atoms.index(a) for a in after]] = Label.TRUE
    values[1, [atoms.index(a) for a in unknown or ()]] = Label.UNKNOWN
    objects = (THE_BAG, THE_HAND, THE_ICE, THE_PLATE)
    return LabelledDemo(name, objects, (Action(PICK, (THE_HAND, item)),), (HELD(item),), atoms, values)


def learned(demos: list[LabelledDemo], learner: str, *pool: Predicate, lift: bool = True) -> list[Operator]:
    table = TruthTable((HELD,), tuple(Candidate(p, float(p.arity)) for p in pool), tuple(demos))
    return list(learn_operators(table, LearningSettings(operators=learner, lift_types=lift)))


def types(operators: list[Operator]) -> list[str]:
    return sorted(op.skill_args[1].type.name for op in operators)


BOTH = pytest.mark.parametrize("learner", ["cluster-and-intersect", "robust"])


@BOTH
def test_what_is_done_alike_is_one_operator_over_the_declared_type(learner: str) -> None:
    demos = [demo("a", THE_BAG, [HELD(THE_BAG)]), demo("b", THE_ICE, [HELD(THE_ICE)])]
    assert types(learned(demos, learner)) == ["item"]
    assert types(learned(demos, learner, lift=False)) == ["bag", "ice"]


@BOTH
def test_one_kind_alone_tells_nothing_apart(learner: str) -> None:
    assert types(learned([demo("a", THE_BAG, [HELD(THE_BAG)])], learner)) == ["item"]


def test_types_with_other_effects_stay_apart() -> None:
    demos = [demo("a", THE_BAG, [HELD(THE_BAG)]), demo("b", THE_ICE, [HELD(THE_ICE), WET(THE_HAND)])]
    assert types(learned(demos, "cluster-and-intersect", WET)) == ["bag", "ice"]


def test_effects_that_are_not_to_be_seen_tell_nothing_apart() -> None:
    demos = [demo("a", THE_BAG, [HELD(THE_BAG)], [WET(THE_HAND)]), demo("b", THE_ICE, [HELD(THE_ICE), WET(THE_HAND)])]
    assert types(learned(demos, "cluster-and-intersect", WET)) == ["item", "item"]


def test_types_that_meet_in_one_of_the_effects_are_not_told_apart() -> None:
    wet = [demo("a", THE_BAG, [HELD(THE_BAG), WET(THE_HAND)]), demo("b", THE_ICE, [HELD(THE_ICE), WET(THE_HAND)])]
    assert types(learned([*wet, demo("c", THE_BAG, [HELD(THE_BAG)])], "cluster-and-intersect", WET)) == ["item"] * 2


@BOTH
def test_an_effect_on_a_special_type_makes_the_variable_special(learner: str) -> None:
    demos = [demo(f"b{i}", THE_BAG, [HELD(THE_BAG)]) for i in range(4)]
    demos += [demo(f"i{i}", THE_ICE, [HELD(THE_ICE), MELTED(THE_ICE)]) for i in range(4)]
    found = learned(demos, learner, MELTED)
    assert types(found) == ["bag", "ice"]
    assert all(
        v.type.is_a(t) for op in found for a in op.add for v, t in zip(a.variables, a.predicate.types, strict=True)
    )


def words(*objects: Object, given: tuple[Predicate, ...] = (BAG_HELD, ICE_HELD)) -> TruthTable:
    atoms = tuple(sorted(p(o) for p in given for o in objects if o.type.is_a(p.types[0])))
    values = np.arange(2 * len(atoms), dtype=np.int8).reshape(2, -1) % 2
    one = LabelledDemo("a", objects, (Action(PICK, (THE_HAND, THE_BAG)),), (), atoms, values)
    return TruthTable((HELD,), tuple(Candidate(p, 1.0) for p in given), (one,))


def test_one_word_about_siblings_is_one_predicate_with_the_labels_of_both() -> None:
    before = words(THE_BAG, THE_HAND, THE_ICE)
    joined = with_shared_words(before, [PICK])
    (candidate,) = joined.pool
    assert candidate.predicate.signature == "held0(item)"
    (one,), (was,) = joined.demos, before.demos
    assert {a.objects: list(one.values[:, i]) for i, a in enumerate(one.atoms)} == {
        a.objects: list(was.values[:, i]) for i, a in enumerate(was.atoms)
    }


def test_a_word_that_was_not_labelled_for_all_of_the_type_stays_as_it_is() -> None:
    spoon = Object("spoon", Type("spoon", (), ITEM))
    for table in (words(THE_BAG, THE_ICE, spoon), words(THE_BAG, THE_ICE, given=(BAG_HELD,))):
        assert with_shared_words(table, [PICK]) is table


@pytest.mark.parametrize("skill", [Skill("Pick", (HAND, BAG)), Skill("Pick", (HAND,)), Skill("Wait", ())])
def test_nothing_is_shared_above_what_skills_declare(skill: Skill) -> None:
    table = words(THE_BAG, THE_ICE)
    assert with_shared_words(table, [skill]) is table


def test_settings_that_do_not_lift_are_written_as_before_there_was_the_option() -> None:
    assert "lift_types" not in LearningSettings().model_dump(mode="json")
    assert LearningSettings(lift_types=True).model_dump(mode="json")["lift_types"] is True


def test_what_is_shared_is_said_with_what_it_was_shown_with() -> None:
    alike = [demo("a", THE_BAG, [HELD(THE_BAG)]), demo("b", THE_ICE, [HELD(THE_ICE)])]
    (one,) = sharing(learned(alike, "robust"), alike)
    assert (one.skill, one.argument, one.shown, one.learned, one.shared) == ("Pick", 1, ("bag", "ice"), ("item",), True)
    apart = [alike[0], demo("b", THE_ICE, [HELD(THE_ICE), WET(THE_HAND)])]
    (other,) = sharing(learned(apart, "cluster-and-intersect", WET), apart)
    assert (other.learned, other.shared) == (("bag", "ice"), False)
