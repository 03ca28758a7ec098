"""A picture before and a picture after, for every operator: a transition that supports it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from pix2pred.learning import Support, SupportKind
from pix2pred.report.contents import Contents
from pix2pred.report.pictures import Album


@dataclass(frozen=True, slots=True)
class TransitionPictures:
    """Numbers of two pictures in the album, and the transition they show."""

    before: int
    after: int
    demo: str
    step: int
    about: str


def shots(contents: Contents, readings: Iterable[Support], album: Album) -> Mapping[str, TransitionPictures]:
    """By operator, the first supporting transition whose pictures are known; none for others."""
    states = {demo.name: demo.states for demo in contents.evidence.demos}
    actions = {demo.name: demo.actions for demo in contents.shown.demos}
    found: dict[str, TransitionPictures] = {}
    for reading in readings:
        there = states.get(reading.demo, ())
        if reading.operator in found or reading.verdict != SupportKind.SUPPORTS or reading.step + 1 >= len(there):
            continue
        before, after = there[reading.step], there[reading.step + 1]
        if before and after:
            found[reading.operator] = TransitionPictures(
                album.number(before[0].digest), album.number(after[0].digest), reading.demo, reading.step + 1,
                str(actions[reading.demo][reading.step]),
            )  # fmt: skip
    return found
