"""``export``: projects and world models in the forms of other places."""

from __future__ import annotations

import json as json_text
from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from pix2pred.cli.console import UsageError, out, print_json
from pix2pred.cli.ranges import output_folder
from pix2pred.demos import DOMAIN, read_project, read_tasks, write_project
from pix2pred.demos.authoring import bare_demo, bare_task
from pix2pred.report.hub_card import Licence, SharedAs, model_card, project_card
from pix2pred.runs.layout import METRICS, MODEL, PDDL, SAMPLERS
from pix2pred.structs.environment import SimulatedTask
from pix2pred.structs.formats.world_model import load_model
from pix2pred.system.files import write_whole

export = App(name="export")
CARD = "README.md"


@export.command(name="hub-folder")
def hub_folder(
    source: Annotated[Path, Parameter(help="Project folder, or run folder.")],
    /,
    *,
    licence: Annotated[Licence, Parameter(help="Under which licence others may use it.")],
    out_dir: Annotated[Path, Parameter(name="--out", help="Folder to write.", validator=output_folder)],
    title: Annotated[str | None, Parameter(help="How it is called [default: the domain's name].")] = None,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
) -> None:
    """Write a folder that can be put on a hub: the data or the model, and a card with licence, content and limits.

    Of a project everything is written, its pictures without place, time and owner. Of a run the learned model is, and
    no picture, answer or path. Nothing is uploaded.

    For example:

    - `pix2pred export hub-folder data/tea --licence cc-by-4.0 --out hub/tea-data`

    - `pix2pred export hub-folder runs/tea --licence mit --title 'Tea for two' --out hub/tea-model`
    """
    if out_dir.exists() and (not out_dir.is_dir() or any(out_dir.iterdir())):
        raise UsageError(f"--out: {out_dir} is there already; name a new folder")
    if (source / MODEL).is_file():
        _write_model(source, out_dir, licence, title)
    elif (source / DOMAIN).is_file():
        _write_project(source, out_dir, licence, title)
    else:
        raise UsageError(f"{source}: is neither a project (no {DOMAIN}) nor a finished run (no {MODEL})")
    if json:
        files = sorted(str(p.relative_to(out_dir)) for p in out_dir.rglob("*") if p.is_file())
        print_json({"folder": str(out_dir), "files": files})
    else:
        out.print(f"written to {out_dir}; read its {CARD}, and say there what the limits are", markup=False)


def _write_project(source: Path, folder: Path, licence: Licence, title: str | None) -> None:
    project = read_project(source)
    tasks = [
        SimulatedTask(bare_task(stored.task), stored.simulator or {})
        for stored in read_tasks(source, project.vocabulary)
    ]
    demos = [bare_demo(demo) for demo in project.demos]
    write_project(
        folder, project.vocabulary, demos, tasks, project.simulator, project.learning, asking=project.asking
    )  # fmt: skip
    card = project_card(project, len(tasks), SharedAs(licence, title or project.vocabulary.name))
    write_whole(folder / CARD, card.encode())


def _write_model(source: Path, folder: Path, licence: Licence, title: str | None) -> None:
    model = load_model(source / MODEL)
    metrics = source / METRICS
    for name in (MODEL, PDDL, SAMPLERS, METRICS):
        if (source / name).is_file():
            write_whole(folder / name, (source / name).read_bytes())
    counts = json_text.loads(metrics.read_bytes()) if metrics.is_file() else {}
    write_whole(folder / CARD, model_card(model, counts, SharedAs(licence, title or model.vocabulary.name)).encode())
