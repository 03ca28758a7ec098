"""``mcp``: a learned world model as tools for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pix2pred.api import load_solver
from pix2pred.cli.console import UsageError
from pix2pred.registry import Registry
from pix2pred.runs.folder import RunFolder
from pix2pred.serving import Tools, server_of


def mcp(
    run: Annotated[Path, Parameter(help="Run folder, as made by learn.")],
    /,
    *,
    photos: Annotated[Path, Parameter(help="Folder whose pictures may be looked at [default: the current one].")] = (
        Path()
    ),
    vlm: Annotated[
        str | None,
        Parameter(
            help="What looks at new photos, and may cost money [default: nothing; only stored answers are used]."
        ),
    ] = None,
    planner: Annotated[
        str, Parameter(help="portfolio, astar-lmcut, gbfs-ff, or an engine of the extra 'planners'.")
    ] = "portfolio",
    registry: Annotated[Registry, Parameter(parse=False)],
) -> None:
    """Serve a world model over the Model Context Protocol, on standard input and output (extra: mcp).

    An assistant that starts this program can read the model, describe photos, plan and check plans. Nothing is
    executed. Without --vlm nothing is asked and nothing written: only pictures that were labelled before can be
    described. With it, answers are kept in the run folder, so that none is paid for twice.

    For example, in an assistant's list of servers:

    - `pix2pred mcp runs/tea --photos ~/Pictures/tea --vlm openai:gpt-4o-mini`
    """
    if not photos.is_dir():
        raise UsageError(f"--photos: {photos} is no folder")
    folder = RunFolder(run)
    looks = vlm or f"replay:{folder.config()['answers'] or run}"
    solver, _ = load_solver(folder, planner, vlm=looks, registry=registry)
    server_of(Tools(folder, solver, photos)).run("stdio")
