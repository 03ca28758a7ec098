"""``mailbox``: answer the questions of a mailbox in the browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pix2pred.cli.console import UsageError, err
from pix2pred.cli.ranges import PORT
from pix2pred.cli.review import serve
from pix2pred.review import MailboxServer
from pix2pred.vlm.mailbox_folder import MailboxFolder


def mailbox(
    folder: Annotated[Path, Parameter(help="The folder behind --vlm mailbox:FOLDER.")],
    /,
    *,
    port: Annotated[int, Parameter(help="Port on this machine [default: a free one].", validator=PORT)] = 0,
    open_browser: Annotated[bool, Parameter(name="--open", help="Open the page in a browser.")] = False,
) -> int:
    """Show the questions of a mailbox, with their pictures and with buttons for the answers.

    It runs beside the command that asks, in another terminal, before or after it: answers are files in FOLDER.
    Ctrl-C ends the server.

    For example:

    - `pix2pred mailbox inbox --open`
    """
    if not folder.is_dir():
        raise UsageError(f"{folder}: is no folder; it appears when a command asks with --vlm mailbox:{folder}")
    with MailboxServer(MailboxFolder(folder), port) as server:
        serve(server, open_browser=open_browser)
    err.print("all answers are saved", style="dim")
    return 0
