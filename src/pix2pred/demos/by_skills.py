"""What skills are declared to set and clear, against what is demonstrated: a step that changes nothing is odd."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pix2pred.structs import Action, Atom, Demo, FromSkills, Predicate, SkillTrigger

Complaint = tuple[tuple[str, int], str]
"""An entry of the demonstration's file, and a sentence about it."""


def contradictions(demo: Demo, initial: Sequence[Predicate]) -> Iterator[Complaint]:
    """Where a demonstration contradicts what its skills are declared to do.

    A predicate is looked at when it holds nowhere at first by declaration, and skills both set and clear it.
    """
    for predicate in initial:
        source = predicate.source
        if isinstance(source, FromSkills) and source.set_by and source.cleared_by and not source.initially:
            yield from _of(demo, predicate, source)


def _of(demo: Demo, predicate: Predicate, source: FromSkills) -> Iterator[Complaint]:
    held = {atom for atom in demo.states[0].given if atom.predicate == predicate}
    for t, action in enumerate(demo.actions):
        if not action.failed:
            cleared = _atoms(predicate, action, source.cleared_by)
            made = _atoms(predicate, action, source.set_by)
            for atom in sorted(made & held):
                yield ("actions", t), _sentence(action, f"sets {atom}, which holds already")
            for atom in sorted(cleared - held - made):
                yield ("actions", t), _sentence(action, f"clears {atom}, which does not hold")
            held = (held - cleared) | made
        for atom in sorted(a for a in demo.states[t + 1].given if a.predicate == predicate and a not in held):
            yield ("states", t + 1), f"{atom} is listed here, and by the skills that set and clear it, it does not hold"


def _atoms(predicate: Predicate, action: Action, triggers: Sequence[SkillTrigger]) -> set[Atom]:
    """What the triggers of the action's skill are about."""
    fitting = (trigger for trigger in triggers if trigger.skill == action.skill.name)
    return {Atom(predicate, tuple(action.objects[i] for i in trigger.args)) for trigger in fitting}


def _sentence(action: Action, does: str) -> str:
    return (
        f"{action} {does}: is a step missing, did one fail (write 'failed' behind it), or does something hold at the "
        "start (list it under 'given' of state 0)?"
    )
