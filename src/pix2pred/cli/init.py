"""``init``: begin a project: what is declared, and an example or your photos in order."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pix2pred.cli.console import bars, err, print_json
from pix2pred.cli.ranges import POSITIVE, quoted
from pix2pred.demos import FolderError
from pix2pred.demos.authoring import (
    MAX_SIDE,
    DeclarationError,
    Declarations,
    Draft,
    Order,
    declare,
    domain_text,
    example_declarations,
    example_drafts,
    refuse_begun,
    write_drafts,
)
from pix2pred.demos.importers import drafts_of_frames
from pix2pred.system.progress import Stage

_TO_FILL_IN = "An example to fill in. Put the photo of each state at images/0/main.jpg, images/1/main.jpg, and so on."

Ask = Callable[[str], str]

_QUESTIONS = (
    ("types", "What kinds of objects are there? cup, or with a parent cup:item"),
    ("objects", "Which objects? red_cup:cup = the red cup"),
    ("skills", "What can be done? Pick(robot, cup)"),
    ("predicates", "What are goals written in? On(cup, tray) = vlm, or = human, or = skills: +Pick(0, 1) -Place(0, 1)"),
)


# Longer than others: every option is a line, with its help.
def init(
    directory: Path,
    /,
    *,
    types: Annotated[
        list[str] | None,
        Parameter(name="--type", negative=(), help="A type: cup; with a parent cup:item; with numbers box[angle]."),
    ] = None,
    objects: Annotated[
        list[str] | None, Parameter(name="--object", negative=(), help="An object: 'red_cup:cup = the red cup'.")
    ] = None,
    skills: Annotated[
        list[str] | None,
        Parameter(name="--skill", negative=(), help="A skill: 'Pick(robot, cup)', 'Pour(cup)[0..90]'."),
    ] = None,
    predicates: Annotated[
        list[str] | None,
        Parameter(
            name="--predicate",
            negative=(),
            help="An initial predicate and the source of its values: 'On(cup, tray) = vlm', '... = human', "
            "'Holding(robot, cup) = skills: +Pick(0, 1) -Place(0, 1)', '... = features: (<= box.angle 0.5)'.",
        ),
    ] = None,
    from_photos: Annotated[
        Path | None, Parameter(help="Photos: one demonstration for each sub-folder, or one when there are none.")
    ] = None,
    order: Annotated[
        Order, Parameter(help="Order of the photos: time taken, name; auto: time if all say it.")
    ] = "auto",
    max_side: Annotated[
        int, Parameter(help="Longest side of the copied photos in pixels; longer ones shrink.", validator=POSITIVE)
    ] = MAX_SIDE,
    no_input: Annotated[bool, Parameter(negative=(), help="Ask nothing, even on a terminal.")] = False,
    overwrite: Annotated[bool, Parameter(negative=(), help="Replace domain.yaml, demos and schemas.")] = False,
    json: Annotated[bool, Parameter(negative=(), help="Print one JSON object on the last line.")] = False,
) -> int:
    """Begin a project: a commented domain.yaml, and demonstrations from photos or an example of one.

    Each option may be given several times. Without any, a terminal is asked; without a terminal the project is an
    example with drawn pictures. Photos are copied upright and without metadata; their actions are left to fill in.

    For example:

    - `pix2pred init my-project`
    - `pix2pred init tea --from-photos photos`
    - `pix2pred init tea --type robot --type cup --object robot:robot --object 'mug:cup = the blue mug'`
    --skill 'Pick(robot, cup)' --predicate 'Holding(robot, cup) = skills: +Pick(0, 1)'
    """
    refuse_begun(directory, overwrite=overwrite)
    photos = _photos(directory, from_photos, order, max_side) if from_photos is not None else None
    given = [types or [], objects or [], skills or [], predicates or []]
    if not any(given) and not no_input and not json and sys.stdin.isatty():
        given = interview(input, lambda text: err.print(text, markup=False))
    declared = declare(*given)
    if photos is not None:
        drafts = photos
    elif any(given):
        drafts = (Draft("example", (None,), (), notes=(_TO_FILL_IN,)),)
    else:
        declared, drafts = example_declarations(), example_drafts()
    _write(directory, drafts, declared, overwrite=overwrite, shown=photos is not None)
    if json:
        print_json({"folder": str(directory), "demonstrations": {d.name: len(d.actions) + 1 for d in drafts}})
        return 0
    for draft in drafts:
        err.print(f"{directory / 'demos' / draft.name}: {draft.notes[0]}", markup=False, soft_wrap=True)
    err.print(f"What to fill in, and where: pix2pred check {quoted(directory)}", markup=False)
    return 0


def _write(directory: Path, drafts: Sequence[Draft], declared: Declarations, *, overwrite: bool, shown: bool) -> None:
    """Write the project; how it goes is ``shown``."""
    with bars() as progress:
        total = sum(len(draft.actions) + 1 for draft in drafts)
        done = 0

        def tell(name: str, _written: int, _of: int) -> None:
            nonlocal done
            done += 1
            if shown:
                progress(Stage.PHOTOS, done, total, name)

        name = directory.resolve().name or "project"
        write_drafts(directory, drafts, domain_text(name, declared), overwrite=overwrite, tell=tell)


def _photos(directory: Path, photos: Path, order: Order, max_side: int) -> tuple[Draft, ...]:
    if directory.resolve().is_relative_to(photos.resolve()):
        raise FolderError.about(directory, f"lies among the photos of {photos}; choose another place")
    return drafts_of_frames(photos, order=order, max_side=max_side)


def interview(ask: Ask, tell: Callable[[str], None]) -> list[list[str]]:
    """Ask for everything, an empty line ending each part; what cannot be understood is said and asked for again.

    Gives types, objects, skills and predicates as the options would; four empty lists for no answer at all.
    """
    given: dict[str, list[str]] = {part: [] for part, _ in _QUESTIONS}
    tell("One answer a line; an empty line goes on. Nothing at all makes an example.")
    for part, question in _QUESTIONS:
        tell(question)
        while answer := _answer(ask, f"{part}> "):
            given[part].append(answer)
            try:
                declare(*given.values())
            except DeclarationError as error:
                given[part].pop()
                tell(f"  {error}")
        if part == "types" and not given[part]:
            break
    return list(given.values())


def _answer(ask: Ask, prompt: str) -> str:
    try:
        return ask(prompt).strip()
    except EOFError:
        return ""
