"""Whether a demonstration is one: its goal holds in the last state alone (method 1.4), and no feature is missing."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.demos.files.documents import Sheet
from pix2pred.structs import Action, Atom, FromDomain, FromHuman, State


def check_goal(sheet: Sheet, goal: Sequence[Atom], states: Sequence[State]) -> None:
    """Report a goal that the given atoms contradict.

    Only atoms of the sources domain and human can be judged here: the file lists all that are true. The values of
    the others are found later.
    """
    for i, atom in enumerate(goal):
        if len(set(atom.objects)) < len(atom.objects):
            sheet.report(("goal", i), f"goal atom {atom} names one object twice; arguments stand for distinct objects")
    listed = [isinstance(atom.predicate.source, FromDomain | FromHuman) for atom in goal]
    for i, atom in enumerate(goal):
        if listed[i] and atom not in states[-1].given:
            message = (
                f"goal atom {atom} is not among the given atoms of the last state; a demonstration ends in its goal"
            )
            sheet.report(("goal", i), message)
    if goal and all(listed):
        for t, state in enumerate(states[:-1]):
            if state.given.issuperset(goal):
                what = "at the start" if t == 0 else f"in state {t}; end the demonstration there"
                sheet.report(("states", t), f"the goal already holds {what}")
                return


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
