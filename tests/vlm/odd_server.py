"""A model on loopback whose every reply a function decides, and replies as public bug reports describe them."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler
from typing import Any

from vlm.fault_server import FaultServer, _send

Reply = tuple[int, Any]


class Scripted(FaultServer):
    """Answers each question as ``reply`` says: a status, and a document or bytes."""

    def __init__(self, reply: Callable[[dict[str, Any]], Reply], headers: dict[str, str] | None = None) -> None:
        super().__init__()
        self.asked: list[dict[str, Any]] = []
        self._reply = reply
        self._more = headers or {}
        self._one = threading.Lock()

    def serve(self, handler: BaseHTTPRequestHandler) -> None:
        body = json.loads(handler.rfile.read(int(handler.headers["content-length"])))
        with self._one:
            self.asked.append(body)
        status, document = self._reply(body)
        content = document if isinstance(document, bytes) else json.dumps(document).encode()
        _send(handler, status, content, self._more)


@contextmanager
def running(server: Scripted) -> Iterator[Scripted]:
    with server.running():
        yield server


def said(content: Any, finish: str | None = "stop", tokens: int = 60, **more: Any) -> Reply:
    message = {"role": "assistant", "content": content} | more.pop("message", {})
    usage = {"prompt_tokens": 1500, "completion_tokens": tokens, "total_tokens": 1500 + tokens}
    choice = {"index": 0, "message": message, "finish_reason": finish}
    return 200, {"id": "c", "object": "chat.completion", "created": 1, "model": "m", "choices": [choice],
                 "usage": usage} | more  # fmt: skip


def refused(message: str, status: int = 400, **more: Any) -> Reply:
    return status, {"error": {"message": message, "type": "invalid_request_error"} | more}


def thinking(tokens: int, text: str = "* lit(a): True. So it is.") -> Callable[[dict[str, Any]], Reply]:
    """A model that thinks ``tokens`` before it speaks; they count towards its budget."""

    def reply(body: dict[str, Any]) -> Reply:
        limit = body.get("max_tokens") or body["max_completion_tokens"]
        if limit < tokens + 40:
            return said("", "length", limit, message={"reasoning_content": "Let me look."})
        return said(text, tokens=tokens + 60)

    return reply
