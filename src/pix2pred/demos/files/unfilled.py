"""What a person still has to fill in: the word that stands there meanwhile, and what is said about it."""

from __future__ import annotations

from collections.abc import Iterable

UNFILLED = "TODO"
"""Stands in place of an action or a goal atom that nobody has written down yet."""

_SHOWN = 6


def is_unfilled(text: str) -> bool:
    """Whether ``text`` was left to be filled in: ``TODO``, ``TODO: which cup?``."""
    return text.strip().upper().startswith(UNFILLED)


def ask_for_action(position: int, skills: Iterable[object]) -> str:
    """What to write in place of the unfilled action at ``position``."""
    return (
        f"to be filled in: the skill that leads from images/{position} to images/{position + 1}"
        f"{_one_of(map(str, skills))}"
    )


def ask_for_atom(where: str, signatures: Iterable[str]) -> str:
    """What to write in place of an unfilled atom of the ``goal`` or of the ``given`` ones."""
    if where == "given":
        return f"to be filled in: the atoms that hold here{_one_of(signatures)}; [] says that none does"
    return f"to be filled in: an atom that holds in the last state and not before{_one_of(signatures)}; or remove it"


def _one_of(choices: Iterable[str]) -> str:
    """The forms to choose from, with types in place of objects; nothing when there are none yet."""
    known = list(choices)
    more = ", ..." if len(known) > _SHOWN else ""
    return f", one of {', '.join(known[:_SHOWN])}{more} with objects for the types" if known else ""
