"""``answers``: looking into an answer store, checking it, and making a copy to share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import App, Parameter

from pix2pred.cli.console import UsageError, counted, err, out, plain, print_json
from pix2pred.vlm import AnswerStore
from pix2pred.vlm.answers.inspection import StoredEntry, find, problems, read_all
from pix2pred.vlm.answers.inspection import export as export_answers

answers = App(name="answers")

_SHOWN = 60
"""Characters of an answer that a list shows."""


def _store(directory: Path) -> AnswerStore:
    if not (directory / "answers").is_dir():
        raise UsageError(f"{directory}: holds no answers (no folder 'answers' in it)")
    return AnswerStore(directory)


@answers.command(name="list")
def list_answers(
    directory: Path,
    /,
    *,
    model: Annotated[str | None, Parameter(help="Only answers of this model.")] = None,
    purpose: Annotated[str | None, Parameter(help="Only propose, label or double-check.")] = None,
    finish: Annotated[str | None, Parameter(help="Only complete, 'cut short', 'too large', refused or none.")] = None,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
) -> int:
    """List stored answers.

    For example:

    - `pix2pred answers list runs/stacks --purpose label`
    """
    chosen = (
        e for e in read_all(_store(directory))
        if model in (None, e.model) and purpose in (None, e.purpose) and finish in (None, e.answer.finish.value)
    )  # fmt: skip
    if json:
        print_json({"answers": [_row(e) for e in chosen]})
        return 0
    count = 0
    for e in chosen:  # line by line: a hundred thousand are no table to lay out
        count += 1
        begins = " ".join(e.answer.text.split())[:_SHOWN]
        print(plain(f"{e.key[:12]}  {e.purpose:<13}  {e.answer.finish.value:<9}  {e.model}  {begins}"), file=out.file)
    out.print(counted(count, "answer"))
    return 0


def _row(e: StoredEntry) -> dict[str, Any]:
    return {
        "key": e.key,
        "purpose": e.purpose,
        "model": e.model,
        "finish": e.answer.finish.value,
        "pictures": len(e.pictures),
        "tokens": [e.answer.spent.input_tokens, e.answer.spent.output_tokens],
        "begins": " ".join(e.answer.text.split())[:_SHOWN],
    }


@answers.command
def show(directory: Path, key: str, /) -> int:
    """Show a question and its answer; KEY may be the beginning of one.

    For example:

    - `pix2pred answers show runs/stacks 1f3a9c`
    """
    store = _store(directory)
    entry = find(store, key)
    asked = {name: entry.request.get(name) for name in ("temperature", "max_tokens", "sample", "attempt")}
    out.print(plain(f"{entry.purpose} query of {entry.model}, {asked}"), markup=False)
    for part in entry.request["parts"]:
        shown = part if isinstance(part, str) else f"[{part.get('heading') or 'picture'}: {store.blob(part['pixels'])}]"
        out.print(plain(f"\n{shown}"), markup=False, soft_wrap=True)
    answer = plain(entry.answer.text)
    out.print(f"\n--- answer ({entry.answer.finish.value}) ---\n{answer}", markup=False, soft_wrap=True)
    return 0


@answers.command
def export(
    directory: Path,
    /,
    *,
    out_file: Annotated[Path, Parameter(name="--out", help="Zip file to write.")],
    model: Annotated[str | None, Parameter(help="Only answers of this model.")] = None,
) -> int:
    """Write answers and pictures into a zip file; unpacked over another store it adds to it.

    For example:

    - `pix2pred answers export runs/stacks --out answers.zip`
    """
    store = _store(directory)
    if not out_file.name or out_file.is_dir():
        raise UsageError(f"--out {str(out_file)!r}: is no name of a file to write")
    count = export_answers(store, out_file, model)
    err.print(f"{count} answers in {out_file}", markup=False)
    return 0


@answers.command
def verify(directory: Path, /, *, json: Annotated[bool, Parameter(help="Print one JSON object.")] = False) -> int:
    """Check that every answer is whole, has the key of its question, and has its pictures.

    For example:

    - `pix2pred answers verify runs/stacks`
    """
    store = _store(directory)
    found = list(problems(store))
    if json:
        print_json({"answers": len(store.all_keys()), "problems": found})
    else:
        for problem in found:
            out.print(plain(problem), markup=False, soft_wrap=True)
        out.print(f"{len(store.all_keys())} answers, " + (counted(len(found), "problem") if found else "no problems"))
    return 2 if found else 0
