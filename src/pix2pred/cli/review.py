"""``review``: look at a run in the browser and correct it."""

from __future__ import annotations

import threading
import webbrowser
from contextlib import suppress
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pix2pred.cli.console import err, out
from pix2pred.cli.ranges import PORT
from pix2pred.report import write_report
from pix2pred.review import ReviewServer
from pix2pred.review.loopback import LoopbackServer
from pix2pred.runs.folder import RunFolder


def review(
    run: Annotated[Path, Parameter(help="Run folder, as made by learn.")],
    /,
    *,
    port: Annotated[int, Parameter(help="Port on this machine [default: a free one].", validator=PORT)] = 0,
    open_browser: Annotated[bool, Parameter(name="--open", help="Open the page in a browser.")] = False,
) -> int:
    """Show the report of a run and correct it: labels, names, synonyms, banned and pinned predicates.

    Corrections are appended to RUN/corrections.jsonl; what the model said is never changed. 'Learn again' in the page
    and 'pix2pred learn --resume RUN' apply them, without asking the model. Ctrl-C ends the server.

    For example:

    - `pix2pred review runs/stacks --open`
    """
    folder = RunFolder(run)
    folder.config()
    with ReviewServer(folder, port) as server:
        serve(server, open_browser=open_browser)
    err.print("all corrections are saved", style="dim")
    write_report(folder)
    return 0


def serve(server: LoopbackServer, *, open_browser: bool) -> None:
    """Say where ``server`` is, open it in a browser if wanted, and serve until Ctrl-C."""
    out.print(server.url, markup=False, soft_wrap=True)
    err.print("Only this machine can open this address; keep it to yourself. Ctrl-C ends.", style="dim")
    if open_browser:
        threading.Timer(0.2, webbrowser.open, (server.url,)).start()
    with suppress(KeyboardInterrupt):
        server.serve_forever()
