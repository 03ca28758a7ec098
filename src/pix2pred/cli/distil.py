"""``distil``: a small reader of one's own, taught by the labels that a large model gave in a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from pix2pred.cli.console import UsageError, bars, err, out, print_json
from pix2pred.cli.ranges import NOT_NEGATIVE, between, output_folder
from pix2pred.runs.distilling.distil import ReaderSources, load_sources
from pix2pred.runs.distilling.distil import distil as distil_run
from pix2pred.runs.folder import RunFolder
from pix2pred.vlm.distilled.files import CARD, CardDoc, TaughtWordDoc
from pix2pred.vlm.distilled.fitting.lesson import FitSettings

_DEFAULTS = FitSettings()


def distil(
    run: Annotated[Path | None, Parameter(help="Run folder, as made by learn; its episodes count, too.")] = None,
    /,
    *,
    with_: Annotated[
        list[Path] | None,
        Parameter(name="--with", help="Further run folders or answer stores in which the same model labelled tasks."),
    ] = None,
    out_: Annotated[
        Path | None, Parameter(name="--out", help="Folder for the reader.", validator=output_folder)
    ] = None,
    resume: Annotated[
        Path | None, Parameter(help="Make this reader anew from what it was made from and all that was said since.")
    ] = None,
    all_: Annotated[
        bool, Parameter(name="--all", help="Teach every word of the pool, not only those of the world model.")
    ] = False,
    sure: Annotated[
        float | None,
        Parameter(help=f"Least probability of an answer [default: {_DEFAULTS.sure}].", validator=between(0.51, 0.999)),
    ] = None,
    seed: Annotated[int | None, Parameter(help="Of what is drawn by chance.", validator=NOT_NEGATIVE)] = None,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
) -> int:
    """Teach small classifiers from the pictures and labels of a run; asks no model, and takes seconds to minutes.

    For example:

    - `pix2pred distil runs/tea --out tea-reader`
    - `pix2pred distil runs/tea --with runs/tea-tuesday --out tea-reader`
    - `pix2pred solve runs/tea --tasks data/tea --vlm reader:tea-reader`
    - `pix2pred solve runs/tea --tasks data/tea --vlm cascade:tea-reader,openai:gpt-4o`
    - `pix2pred distil --resume tea-reader`
    """
    changed: dict[str, Any] = {name: value for name, value in (("sure", sure), ("seed", seed)) if value is not None}
    if resume is not None:
        if run is not None or out_ is not None or all_:
            raise UsageError("--resume READER takes the run and the words from the reader; leave out RUN, --out, --all")
        before = load_sources(resume).extended(with_ or [])
        settings = FitSettings.model_validate(before.settings.model_dump() | changed)
        sources, folder = ReaderSources(before.run, before.episodes, before.everything, settings), resume
    elif run is None or out_ is None:
        raise UsageError("name a run and a folder for the reader: pix2pred distil RUN --out READER")
    else:
        sources, folder = ReaderSources(run, tuple(with_ or ()), all_, FitSettings.model_validate(changed)), out_
    RunFolder(sources.run).config()
    with bars() as progress:
        card = distil_run(sources, folder, progress)
    if json:
        print_json(summary(card))
    else:
        _print(card)
        err.print(f"reader: {folder} (its card: {folder / CARD})", markup=False)
    return 0


def summary(card: CardDoc) -> dict[str, Any]:
    """What the card says, without how words are computed."""
    words = [w.model_dump(mode="json", exclude={"kernel", "curve"}) for w in card.words]
    untaught = [u.model_dump(mode="json") for u in card.untaught]
    return {"made_from": card.made_from.model_dump(mode="json"), "words": words, "untaught": untaught}


def _print(card: CardDoc) -> None:
    made = card.made_from
    out.print(
        f"Taught by {made.teacher} with {made.labels} labels of {made.looks} looks: {made.demonstrations} "
        f"demonstrations, {made.episodes} episodes. {made.corrected} were corrected and {made.doubted} doubted.",
        markup=False,
    )
    out.print("On demonstrations and episodes left out:")
    for word in card.words:
        out.print(f"  {_about(word)}", markup=False, soft_wrap=True)
    if not any(word.answered for word in card.words):
        out.print(
            "It knew nothing of what was left out, so it leaves all to the large model: boxes about the objects, more "
            "demonstrations, or episodes with --with would help.",
            markup=False,
        )
    for left in card.untaught:
        out.print(f"  not taught: {left.word}({', '.join(left.kinds)}) {left.reason}", markup=False, soft_wrap=True)


def _about(word: TaughtWordDoc) -> str:
    right = f"{word.right / word.answered:.1%} as its teacher" if word.answered else "none"
    return (
        f"{word.word}({', '.join(word.kinds)}): answers {word.answered} of {word.seen}, {right}; takes "
        f"{word.teacher_error:.0%} of its teacher's labels to be wrong"
    )
