"""Folders of photos or frames: one picture a state, or a moment named for every state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from pix2pred.demos.authoring.drafts import Draft
from pix2pred.demos.authoring.photos import Order, PhotoSeries, clean_copies, find_photos
from pix2pred.demos.files.problems import FolderError, Problem
from pix2pred.demos.files.sidecar import Segment, read_sidecar
from pix2pred.demos.photos.copies import MAX_SIDE
from pix2pred.structs import Image

UNKNOWN = ("Not known from photos: where the objects are (boxes), their features, given atoms of the source human.",)

ACTIONS = "options_traj.txt"
"""A list of actions beside the states of a demonstration, as the method's authors keep it."""


def drafts_of_frames(
    source: Path, segments: Sequence[Segment] = (), *, order: Order = "auto", max_side: int = MAX_SIDE
) -> tuple[Draft, ...]:
    """One draft for each series of photos in ``source``; ``segments`` name the actions, otherwise they are left open.

    With times, which count frames from 0, a series may hold more frames than states. Raises ``FolderError``; photos
    that cannot be read are all named when the last has been gone through.
    """
    series = find_photos(source, order)
    if not segments:
        return tuple(_draft(s, _actions_beside(s), max_side) for s in series)
    found: list[Problem] = []
    drafts = []
    for segment in segments:
        chosen = _series_of(segment, series, found)
        if chosen is not None:
            drafts.append(_cut(segment, chosen, max_side, found))
    if found:
        raise FolderError(found)
    return tuple(drafts)


def _actions_beside(series: PhotoSeries) -> tuple[str | None, ...]:
    """What a list of actions beside the photos says; without one they are to be filled in. Raises ``FolderError``."""
    file = series.folder / ACTIONS
    if not file.is_file():
        return (None,) * (len(series) - 1)
    (segment,) = read_sidecar(file)
    steps = tuple(step.do for step in segment.doc.steps)
    if len(steps) != len(series) - 1:
        raise FolderError.about(
            file, f"{len(steps)} actions need {len(steps) + 1} pictures, {series.folder} has {len(series)}"
        )
    return steps


def _draft(series: PhotoSeries, actions: tuple[str | None, ...], max_side: int) -> Draft:
    notes = (f"{len(series)} photos, {series.note}.", *UNKNOWN)
    return Draft(series.name, actions, _copies(series, max_side), notes=notes)


def _series_of(segment: Segment, series: Sequence[PhotoSeries], found: list[Problem]) -> PhotoSeries | None:
    wanted = segment.doc.source
    if wanted is None and len(series) == 1:
        return series[0]
    name = str(wanted) if wanted is not None else segment.doc.name
    for one in series:
        if name in (one.folder.name, one.name):
            return one
    known = ", ".join(s.folder.name for s in series[:20])
    loc = ("from",) if wanted is not None else ("name",)
    found.append(segment.problem(loc, f"there is no folder {name!r}; there are {known}: say which with 'from'"))
    return None


def _cut(segment: Segment, series: PhotoSeries, max_side: int, found: list[Problem]) -> Draft:
    """The frames of ``series`` that show the states of ``segment``."""
    doc = segment.doc
    picked = series
    if segment.has_moments():
        positions: list[int] = []
        try:
            positions = [round(moment) for moment in segment.moments()]
        except FolderError as error:
            found += error.problems
        for i, position in enumerate(positions):
            if position >= len(series):
                loc = ("steps", i - 1) if i else ("start",)
                message = f"there is no frame {position}; {series.folder} has {len(series)}, counted from 0"
                found.append(segment.problem(loc, message))
        if positions and positions[-1] < len(series):
            cameras = {c: tuple(paths[p] for p in positions) for c, paths in series.cameras.items()}
            picked = replace(series, cameras=cameras)
    elif len(series) != len(doc.steps) + 1:
        message = f"{len(doc.steps)} actions need {len(doc.steps) + 1} pictures, {series.folder} has {len(series)}"
        found.append(segment.problem(("steps",), f"{message}; say with 'until' which picture shows the end of each"))
    draft = _draft(picked, tuple(step.do for step in doc.steps), max_side)
    return replace(draft, name=doc.name, objects=doc.objects, goal=doc.goal)


def _copies(series: PhotoSeries, max_side: int) -> Iterator[Mapping[str, Image]]:
    """The clean copies of a series, made while they are gone through; at the end, all that could not be read."""
    found: list[Problem] = []
    yield from clean_copies(series, max_side, found)
    if found:
        raise FolderError(found)
