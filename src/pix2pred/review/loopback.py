"""One small server for one person on this machine: what every page of ours that listens has in common.

It listens on the loopback interface only. Its address holds a random token; requests without it, from other origins,
or to another host name (DNS rebinding) are refused before anything is read. Every page forbids framing, referrers and
scripts other than its own.
"""

from __future__ import annotations

import hmac
import json
import secrets
from abc import abstractmethod
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

LOOPBACK = "127.0.0.1"
MAX_BODY = 1 << 20
"""Longer requests are refused."""
MOST_READ = 4 * MAX_BODY
"""Bytes of a body that is too large which are read all the same, and thrown away; what is longer is hung up on."""

LONGEST_LENGTH = 18
"""Digits of a length; thousands of them are no number to Python."""

_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}


class LoopbackServer(ThreadingHTTPServer):
    """Serves what ``handler`` answers. ``port`` 0 takes a free one."""

    daemon_threads = True

    def __init__(self, handler: type[LoopbackHandler], port: int = 0) -> None:
        self.token = secrets.token_urlsafe(24)
        super().__init__((LOOPBACK, port), handler)

    @property
    def url(self) -> str:
        """The only address that answers."""
        return f"http://{LOOPBACK}:{self.server_port}/{self.token}/"


class LoopbackHandler(BaseHTTPRequestHandler):
    """Lets through what comes from our own page; subclasses say what stands below the token."""

    server: LoopbackServer
    server_version = "pix2pred"
    sys_version = ""
    timeout = 60

    @abstractmethod
    def get(self, name: str) -> None:
        """Answer a request for ``name``, which passed. Raises ``ValueError`` or ``OSError`` for damaged files."""

    @abstractmethod
    def post(self, name: str, body: Any) -> None:
        """Answer the JSON ``body`` sent to ``name``. Raises ``OSError`` when it could not be saved."""

    def do_GET(self) -> None:
        """What ``get`` gives, for requests that may pass."""
        name = self._admitted()
        if name is None:
            return
        try:
            self.get(name)
        except ConnectionError:  # whoever asked has gone
            self.close_connection = True
        except (ValueError, OSError) as error:  # damaged files, by hand or by a disk
            self.refuse(HTTPStatus.INTERNAL_SERVER_ERROR, str(error))

    def do_POST(self) -> None:
        """What ``post`` gives, for requests that may pass and hold JSON."""
        name = self._admitted()
        body = None if name is None else self._body()
        if name is None or body is None:
            return
        try:
            self.post(name, body)
        except ConnectionError:
            self.close_connection = True
        except OSError as error:
            self.json(HTTPStatus.INTERNAL_SERVER_ERROR, {"error": f"not saved: {error}"})

    def _admitted(self) -> str | None:
        """What is asked for below the token; None, answered, when the request may not pass."""
        port = self.server.server_port
        hosts = {f"{LOOPBACK}:{port}", f"localhost:{port}"}
        origin = self.headers.get("Origin")
        site = self.headers.get("Sec-Fetch-Site", "same-origin")
        host = self.headers.get_all("Host") or []
        if len(host) != 1 or host[0] not in hosts:
            self.refuse(HTTPStatus.FORBIDDEN, "this server answers to the address it printed alone")
            return None
        if (origin is not None and origin != f"http://{host[0]}") or site not in ("same-origin", "none"):
            self.refuse(HTTPStatus.FORBIDDEN, "requests from other sites are refused")
            return None
        token, _, name = self.path.removeprefix("/").partition("/")
        if not hmac.compare_digest(token.encode(), self.server.token.encode()):
            self.refuse(HTTPStatus.FORBIDDEN, "the address lacks the token that the program printed")
            return None
        return name

    def _body(self) -> Any:
        """The JSON of a request; None, answered, when there is none of a sane size."""
        kind = self.headers.get("Content-Type", "").partition(";")[0].strip()
        length = self.headers.get("Content-Length", "")
        if kind != "application/json" or not length.isdecimal():
            self.refuse(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "expected JSON with its length")
        elif len(length) > LONGEST_LENGTH:
            self.refuse(HTTPStatus.BAD_REQUEST, "no request is that long")
        elif int(length) > MAX_BODY:
            if int(length) <= MOST_READ:
                self.rfile.read(int(length))  # who is still sending would not hear the answer
            self.refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"more than {MAX_BODY} bytes")
        else:
            try:
                body = json.loads(self.rfile.read(int(length)))
            except (ValueError, RecursionError):
                self.refuse(HTTPStatus.BAD_REQUEST, "this is no JSON")
            else:
                return {} if body is None else body
        return None

    def json(self, status: HTTPStatus, data: Any) -> None:
        """Answer with ``data``."""
        self.send(status, json.dumps(data).encode(), "application/json")

    def refuse(self, status: HTTPStatus, why: str) -> None:
        """Answer in words, and hang up."""
        self.close_connection = True
        self.send(status, why.encode(), "text/plain; charset=utf-8")

    def send(self, status: HTTPStatus, content: bytes, kind: str) -> None:
        """Answer with ``content``, of the media type ``kind``."""
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        for header, value in _HEADERS.items():
            self.send_header(header, value)
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: Any) -> None:
        """Silent: the address in a log line would give the token away."""
