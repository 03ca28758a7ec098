"""Whether the goal of a demonstration holds in its last state, and not before (method 1.4)."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.demos.files.documents import Sheet
from pix2pred.structs import Atom, FromDomain, FromHuman, State


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
