"""The mailbox in a browser: questions with their pictures, and buttons for the answers."""

from __future__ import annotations

from dataclasses import asdict
from http import HTTPStatus
from typing import Any
from urllib.parse import unquote

from pix2pred.report.mailbox_page import mailbox_page
from pix2pred.review.loopback import LoopbackHandler, LoopbackServer
from pix2pred.vlm.mailbox_folder import MailboxError, MailboxFolder


class MailboxServer(LoopbackServer):
    """Serves one mailbox. ``port`` 0 takes a free one."""

    def __init__(self, folder: MailboxFolder, port: int = 0) -> None:
        self.folder = folder
        super().__init__(_Handler, port)


class _Handler(LoopbackHandler):
    server: MailboxServer

    def get(self, name: str) -> None:
        """The page, what waits, one question, or one of its pictures."""
        folder = self.server.folder
        what, _, rest = unquote(name).partition("/")
        question, _, file = rest.partition("/")
        try:
            match what:
                case "":
                    self.send(HTTPStatus.OK, mailbox_page().encode(), "text/html; charset=utf-8")
                case "standing":
                    self.json(HTTPStatus.OK, asdict(folder.standing()))
                case "question":
                    self.json(HTTPStatus.OK, asdict(folder.question(question)))
                case "picture":
                    self.send(HTTPStatus.OK, folder.picture(question, file), "image/png")
                case _:
                    self.refuse(HTTPStatus.NOT_FOUND, "nothing here")
        except MailboxError as error:
            self.refuse(HTTPStatus.NOT_FOUND, str(error))

    def post(self, name: str, body: Any) -> None:
        """An answer to a question that waits."""
        what, _, question = unquote(name).partition("/")
        if what != "answer" or not isinstance(body, dict):
            self.refuse(HTTPStatus.NOT_FOUND, "nothing here")
            return
        try:
            self.server.folder.answer(question, body)
        except MailboxError as error:
            self.json(HTTPStatus.BAD_REQUEST, {"error": str(error)})
        else:
            self.json(HTTPStatus.OK, asdict(self.server.folder.standing()))
