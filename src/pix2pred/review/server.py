"""The review server: the report with corrections, for one person on this machine."""

from __future__ import annotations

from http import HTTPStatus
from typing import Any

from pix2pred.predicates import CorrectionsError
from pix2pred.report import load_contents, render
from pix2pred.review.log import StaleError
from pix2pred.review.loopback import LoopbackHandler, LoopbackServer
from pix2pred.review.session import ReviewSession
from pix2pred.runs.folder import RunFolder


class ReviewServer(LoopbackServer):
    """Serves one run. ``port`` 0 takes a free one."""

    def __init__(self, run: RunFolder, port: int = 0, session: ReviewSession | None = None) -> None:
        self.session = session or ReviewSession(run)
        super().__init__(_Handler, port)


class _Handler(LoopbackHandler):
    server: ReviewServer

    def get(self, name: str) -> None:
        """The page, the corrections in force, or how learning is going."""
        session = self.server.session
        if name == "":
            page = render(load_contents(session.run), review=True).encode()
            self.send(HTTPStatus.OK, page, "text/html; charset=utf-8")
        elif name == "state":
            self.json(HTTPStatus.OK, session.state())
        else:
            self.refuse(HTTPStatus.NOT_FOUND, "nothing here")

    def post(self, name: str, body: Any) -> None:
        """New corrections, or the wish to learn again."""
        session = self.server.session
        try:
            if name == "corrections":
                self.json(HTTPStatus.OK, session.correct(body))
            elif name == "learn":
                self.json(HTTPStatus.ACCEPTED, session.learn())
            else:
                self.refuse(HTTPStatus.NOT_FOUND, "nothing here")
        except StaleError as error:
            self.json(HTTPStatus.CONFLICT, {"error": str(error), **session.state()})
        except CorrectionsError as error:
            self.json(HTTPStatus.BAD_REQUEST, {"error": str(error)})
