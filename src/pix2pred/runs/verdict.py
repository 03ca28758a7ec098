"""The verdict on a learned world model, in sentences: whether its plans can be right, and what to do if not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pix2pred.structs import FromFeatures, GroundOperator, LabelledDemo, LiftedAtom, Operator, Predicate, WorldModel
from pix2pred.structs.expressions import in_words, parse_expression
from pix2pred.structs.goals.opposites import affirmed, is_denial
from pix2pred.structs.plans import changes

_MADE = {True: "becomes true", False: "becomes false"}


@dataclass(frozen=True, slots=True)
class Concern:
    """Something that makes the model, or a part of it, useless. ``remedy`` says what to do about it."""

    text: str
    remedy: str

    def __str__(self) -> str:
        return f"{self.text} {self.remedy}".strip()


@dataclass(frozen=True, slots=True)
class Climbed:
    """How selection went: candidates there were, whether none was tried, J at the start, and the threshold it stops at.

    ``threshold`` is None where the stopping rule has none.
    """

    candidates: int
    at_once: bool
    first_j: float
    threshold: float | None


def concerns(model: WorldModel, demos: Sequence[LabelledDemo], climbed: Climbed) -> tuple[Concern, ...]:
    """What is wrong with ``model``, learned from ``demos``; the worst first. Empty when nothing stands out."""
    found = (*_of_goals(model, demos), *_of_operators(model, demos), *_of_labels(model, demos))
    return (*_of_selection(model, climbed, useful=not found), *found)


def doubts_about(plan: Iterable[GroundOperator]) -> tuple[str, ...]:
    """Why not to rely on a plan, a sentence per step: steps whose operators would be useless in any plan."""
    return tuple(
        f"step {number}, {step.operator.skill.name}: its operator needs nothing, so nobody knows whether it works here"
        for number, step in enumerate(plan, start=1)
        if not step.operator.preconditions
    )


def _of_selection(model: WorldModel, climbed: Climbed, *, useful: bool) -> Iterable[Concern]:
    if climbed.at_once:
        yield Concern(
            f"No candidate was tried: before anything was selected J was {climbed.first_j:,.0f}, and selection stops "
            f"at or below j_threshold = {climbed.threshold or 0:,.0f}.",
            "Learn again with 'operators: robust', which needs no threshold, or with a smaller j_threshold.",
        )
    elif not useful and not model.selected and climbed.candidates:
        yield Concern(
            f"None of {climbed.candidates} candidate predicates was selected: none made planning in the demonstrations "
            "easier.",
            "The report says what became of each; more varied demonstrations tell them apart.",
        )
    elif not useful and not climbed.candidates:
        yield Concern(
            "There was no candidate predicate: nothing that was proposed is ever true.",
            "Look at the labels in the report; correct them with 'pix2pred review'.",
        )


def _of_goals(model: WorldModel, demos: Sequence[LabelledDemo]) -> Iterable[Concern]:
    wanted = {(affirmed(a).predicate.name, not is_denial(a)) for demo in demos for a in demo.reached}
    made = {(a.predicate.name, True) for op in model.operators for a in op.add}
    made |= {(a.predicate.name, False) for op in model.operators for a in op.delete}
    for name, value in sorted(wanted - made):
        yield Concern(
            f"No operator makes {name} {str(value).lower()}, which the goals of the demonstrations ask for.",
            f"Look at its values in the report: it has to become {str(value).lower()} after a skill, in several "
            "demonstrations.",
        )


def _of_operators(model: WorldModel, demos: Sequence[LabelledDemo]) -> Iterable[Concern]:
    learned = {op.skill.name for op in model.operators}
    executed = {action.skill.name for demo in demos for action in demo.actions}
    for skill in model.vocabulary.skills:
        if skill.name in executed - learned:
            yield Concern(
                f"No operator was learned for the skill {skill.name}, so no plan uses it.",
                "Nothing that is labelled changes with it often enough; more demonstrations of it help.",
            )
    for op in model.operators:
        if not (op.add or op.delete):
            yield Concern(
                f"{op.skill.name} ({op.name}) has no effect: no plan has a reason to use it.",
                "No selected predicate tells the pictures before it from those after it.",
            )
        elif not op.preconditions:
            yield Concern(
                f"{op.skill.name} ({op.name}) needs nothing: plans use it at any time, also where it cannot work.",
                "No selected predicate tells when it may be used.",
            )


def _of_labels(model: WorldModel, demos: Sequence[LabelledDemo]) -> Iterable[Concern]:
    """Operators of which most transitions end, by their labels, without one of the effects."""
    from pix2pred.learning import operator_support  # here, because commands that judge no model do without learning

    narrow = [demo.restricted(model.predicates) for demo in demos]
    states = {demo.name: demo.abstract_states() for demo in narrow}
    objects = {demo.name: {o.name: o for o in demo.objects} for demo in narrow}
    fitting = [s for s in operator_support(model.operators, narrow) if s.verdict != s.verdict.UNMET]
    for op in model.operators:
        mine = [s for s in fitting if s.operator == op.name]
        broken: Counter[str] = Counter()
        for s in mine:
            ground = op.ground(tuple(objects[s.demo][name] for name in s.binding))
            after = states[s.demo][s.step + 1]
            broken.update(
                {
                    f"{c.atom.predicate.name} {_MADE[c.holds]}"
                    for c in changes(ground.add - after, ground.delete & after)
                }
            )
        worst, count = max(broken.items(), key=lambda item: (item[1], item[0]), default=("", 0))
        if 2 * count > len(mine):
            yield Concern(
                f"{op.skill.name} ({op.name}) is at odds with its pictures: its effect {worst} is not labelled "
                f"after {count} of the {len(mine)} times it was executed.",
                "If these labels are right, learn with 'operators: cluster-and-intersect', which believes them.",
            )


def sentences(operators: Iterable[Operator]) -> tuple[str, ...]:
    """What each operator says, to read aloud: what it needs, and what is so afterwards.

    Objects are called by their types, with a number where an operator has several of one type.
    """
    return tuple(_sentence(op) for op in operators)


def _sentence(op: Operator) -> str:
    said = spoken(op)
    needs = ", ".join(said.needs) or "nothing"
    held, gone = ", ".join(said.adds), ", ".join(said.deletes)
    after = "; ".join(part for part in (held and f"then {held}", gone and f"no longer {gone}") if part)
    return f"{said.skill} needs {needs}; {after or 'changes nothing'}."


@dataclass(frozen=True, slots=True)
class Spoken:
    """An operator in words, with its objects called by their types.

    ``needs`` are preconditions, ``adds`` and ``deletes`` effects; all are atoms as text, sorted.
    """

    skill: str
    needs: tuple[str, ...]
    adds: tuple[str, ...]
    deletes: tuple[str, ...]


def spoken(op: Operator) -> Spoken:
    """``op`` in words; objects of one type are numbered where it has several."""
    types = [v.type.name for v in op.parameters]
    called = {
        v: t if types.count(t) == 1 else f"{t} {types[: i + 1].count(t)}"
        for i, (v, t) in enumerate(zip(op.parameters, types, strict=True))
    }

    def said(atoms: Iterable[LiftedAtom]) -> tuple[str, ...]:
        return tuple(_said_of(a.predicate, [called[v] for v in a.variables]) for a in sorted(atoms))

    skill = f"{op.skill.name}({', '.join(called[v] for v in op.skill_args)})"
    return Spoken(skill, said(op.preconditions), said(op.add), said(op.delete))


def _said_of(predicate: Predicate, arguments: Sequence[str]) -> str:
    """``on(cup, tray)``; a predicate of the feature grammar, whose name is a formula, as one says it."""
    if "[" in predicate.name and (words := meaning(predicate, *arguments)):
        return words
    return f"{predicate.name}({', '.join(arguments)})"


def meaning(predicate: Predicate, called: str = "") -> str:
    """``fingers of the robot at most 0.5``; empty for a predicate that is not computed from features."""
    source = predicate.source
    return in_words(parse_expression(source.expression), called) if isinstance(source, FromFeatures) else ""
