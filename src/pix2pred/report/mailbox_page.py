"""The page on which questions of a mailbox are answered; all it shows comes from the server that serves it."""

from __future__ import annotations

from markupsafe import Markup

from pix2pred.report.page import asset, environment, policy


def mailbox_page() -> str:
    """The page as one HTML file."""
    script = asset("mailbox.js")
    return (
        environment()
        .get_template("mailbox.html.j2")
        .render(
            style=Markup(asset("style.css") + asset("mailbox.css")),
            script=Markup(script),
            policy=policy([script], served=True),
        )
    )
