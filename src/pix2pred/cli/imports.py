"""``import``: photos, frames, videos and LeRobot datasets as demonstrations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from json import dumps
from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from pix2pred.cli.console import UsageError, bars, counted, err, out, print_json
from pix2pred.cli.ranges import POSITIVE, quoted
from pix2pred.demos import DOMAIN, inspect_project
from pix2pred.demos.authoring import MAX_SIDE, Declarations, Draft, Order, domain_text, write_drafts
from pix2pred.demos.importers import (
    drafts_of_frames,
    drafts_of_lerobot,
    drafts_of_videos,
    read_sidecar,
    traces_of_bits,
    with_labels,
)
from pix2pred.system.files import write_whole
from pix2pred.system.progress import Stage

imports = App(name="import")


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Into:
    """Options of every import: where it goes, and how it is told."""

    out: Annotated[Path, Parameter(help="Project folder: demonstrations are added, or a project is begun.")]
    max_side: Annotated[
        int, Parameter(help="Longest side of pictures in pixels; longer ones shrink.", validator=POSITIVE)
    ] = MAX_SIDE
    overwrite: Annotated[bool, Parameter(negative=(), help="Replace demonstrations of the same names.")] = False
    json: Annotated[bool, Parameter(negative=(), help="Print one JSON object on the last line.")] = False


@imports.command
def frames(
    source: Path,
    /,
    *,
    actions: Annotated[
        Path | None,
        Parameter(name=("--actions", "--sidecar"), help="Actions: .txt, one a line; .csv or .yaml with positions too."),
    ] = None,
    labels: Annotated[
        Path | None,
        Parameter(help="Labels of all states, as the method's authors keep them: {atoms} -> action -> {atoms}."),
    ] = None,
    into: Into,
    order: Annotated[
        Order, Parameter(help="Order of the photos: time taken, name; auto: time if all say it.")
    ] = "auto",
) -> int:
    """Bring in folders of photos or frames; without a list of actions these are left to fill in.

    For example:

    - `pix2pred import frames photos --out tea`
    - `pix2pred import frames photos/tea-1 --actions tea-1.txt --out tea`
    """
    segments = read_sidecar(actions) if actions else ()
    drafts = drafts_of_frames(source, segments, order=order, max_side=into.max_side)
    return _bring(with_labels(labels, drafts) if labels else drafts, into)


@imports.command
def video(
    source: Path,
    /,
    *,
    actions: Annotated[
        Path, Parameter(name=("--actions", "--sidecar"), help="Table of times: .csv (seconds, action) or .yaml.")
    ],
    into: Into,
) -> int:
    """Bring in a video, or a folder of videos, at the times at which actions are done (extra video).

    For example:

    - `pix2pred import video tea.mp4 --actions tea.csv --out tea`
    """
    return _bring(drafts_of_videos(source, read_sidecar(actions), max_side=into.max_side), into)


@imports.command
def lerobot(
    source: Path,
    /,
    *,
    actions: Annotated[
        Path | None,
        Parameter(
            name=("--sidecar", "--actions"),
            help="Which steps each episode has: .yaml or .csv [default: the dataset's own subtasks].",
        ),
    ] = None,
    into: Into,
) -> int:
    """Bring in episodes of a LeRobot dataset of format v2 or v3 that lies on disk (extra lerobot).

    For example:

    - `pix2pred import lerobot datasets/pick-cubes --sidecar steps.yaml --out cubes`
    """
    segments = read_sidecar(actions) if actions else ()
    return _bring(drafts_of_lerobot(source, segments, max_side=into.max_side), into)


@imports.command
def bits(
    source: Path,
    /,
    *,
    out: Annotated[Path, Parameter(name="--out", help="Traces file to write: .json, for select.")],
    overwrite: Annotated[bool, Parameter(negative=(), help="Replace the file.")] = False,
    json: Annotated[bool, Parameter(negative=(), help="Print one JSON object on the last line.")] = False,
) -> int:
    """Bring in states as bits and actions as numbers, in turn, one a line; an empty line begins another trace.

    For example:

    - `pix2pred import bits plans.txt --out plans.json`
    """
    if out.exists() and not overwrite:
        raise UsageError(f"{out}: is there already; replace it with --overwrite or choose another file")
    document = traces_of_bits(source)
    write_whole(out, dumps(document, indent=1).encode())
    counts = {"traces": len(document["demos"]), "bits": len(document["predicates"]), "actions": len(document["skills"])}
    if json:
        print_json({"file": str(out), **counts})
    else:
        told = ", ".join(counted(n, what.removesuffix("s")) for what, n in counts.items())
        err.print(f"{told}; next: pix2pred select {quoted(out)} --out selection.json --pddl pddl", markup=False)
    return 0


def _bring(drafts: Sequence[Draft], into: Into) -> int:
    """Write the drafts, and say what is still to be done."""
    project = into.out
    begun = (project / DOMAIN).exists()
    domain = None if begun else domain_text(project.resolve().name, Declarations())
    total = sum(len(draft.actions) + 1 for draft in drafts)
    with bars() as progress:
        done = 0

        def tell(name: str, _written: int, _of: int) -> None:
            nonlocal done
            done += 1
            progress(Stage.IMPORT, done, total, name)

        write_drafts(project, drafts, domain, overwrite=into.overwrite, tell=tell)
    problems = inspect_project(project).problems
    if into.json:
        names = {draft.name: len(draft.actions) + 1 for draft in drafts}
        notes = {draft.name: list(draft.notes) for draft in drafts}
        print_json({"folder": str(project), "demonstrations": names, "notes": notes, "problems": len(problems)})
        return 0
    for draft in drafts:
        out.print(f"{draft.name}: {len(draft.actions) + 1} states", markup=False)
    for note in dict.fromkeys(note for draft in drafts for note in draft.notes):
        out.print(f"  {note}", markup=False, soft_wrap=True)
    if problems:
        err.print(
            f"{counted(len(problems), 'thing')} to fill in or put right: pix2pred check {quoted(project)}", markup=False
        )
    return 0
