"""Whether a demonstration is one: its goal holds in the last state alone (method 1.4), and no feature is missing."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.demos.files.documents import Sheet
from pix2pred.demos.files.yaml_lines import Loc
from pix2pred.structs import Action, Atom, FromDomain, FromHuman, State
from pix2pred.structs.goals.opposites import affirmed, holds, is_denial


def check_goals(sheet: Sheet, goals: Sequence[tuple[Atom, ...]], states: Sequence[State]) -> None:
    """Report goals of which, by the given atoms, none holds in the last state, or one holds before.

    Only atoms of the sources domain and human can be judged here: the file lists all that are true. The values of
    the others are found later.
    """
    for atom in dict.fromkeys(atom for goal in goals for atom in goal):
        if len(set(atom.objects)) < len(atom.objects):
            message = f"goal atom {atom} names one object twice; arguments stand for distinct objects"
            sheet.report(_where(atom, goals), message)
    last = states[-1].given
    contradicted = [[atom for atom in goal if _is_listed(atom) and not holds([atom], last)] for goal in goals]
    if all(contradicted):
        for atom in contradicted[0]:
            given = "is among" if is_denial(atom) else "is not among"
            others = " (and no other way to reach the goal holds)" if len(goals) > 1 else ""
            sheet.report(
                _where(atom, goals),
                f"goal atom {atom}: {affirmed(atom)} {given} the given atoms of the last state{others}; a "
                "demonstration ends in its goal",
            )
        return
    certain = [goal for goal in goals if goal and all(map(_is_listed, goal))]
    for t, state in enumerate(states[:-1]):
        if any(holds(goal, state.given) for goal in certain):
            what = "at the start" if t == 0 else f"in state {t}; end the demonstration there"
            sheet.report(("states", t), f"the goal already holds {what}")
            return


def _is_listed(atom: Atom) -> bool:
    """Whether states list ``atom``, or what it denies, where it holds."""
    return isinstance(affirmed(atom).predicate.source, FromDomain | FromHuman)


def _where(atom: Atom, goals: Sequence[tuple[Atom, ...]]) -> Loc:
    """The entry of ``atom``, where every entry is an atom."""
    return ("goal",) if len(goals) > 1 else ("goal", goals[0].index(atom))


def check_features(sheet: Sheet, actions: Sequence[Action], states: Sequence[State]) -> None:
    """Report states in which continuous parameters were chosen for an object whose features nobody gives.

    What chooses such parameters is learned from the features of a skill's arguments; without them learning would fail
    after all questions were asked.
    """
    for t, (action, state) in enumerate(zip(actions, states, strict=False)):
        missing = [o.name for o in action.objects if o.type.features and o not in state.features]
        if action.skill.dimension and missing:
            needed = (
                f"{action.skill.name} has continuous parameters, which are learned from the features of its arguments"
            )
            sheet.report(("states", t), f"the features of {missing[0]} are missing; {needed}")
