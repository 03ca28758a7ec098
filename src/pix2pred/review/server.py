"""The review server: the report with corrections, for one person on this machine.

It listens on the loopback interface only. Its address holds a random token; requests without it, from other origins,
or to another host name (DNS rebinding) are refused before anything is read. Every page forbids framing, referrers and
scripts other than its own.
"""

from __future__ import annotations

import hmac
import json
import secrets
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from pix2pred.predicates import CorrectionsError
from pix2pred.report import load_contents, render
from pix2pred.review.log import StaleError
from pix2pred.review.session import Session
from pix2pred.runs.folder import RunFolder

LOOPBACK = "127.0.0.1"
MAX_BODY = 1 << 20
"""Longer requests are refused."""

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


class ReviewServer(ThreadingHTTPServer):
    """Serves one run. ``port`` 0 takes a free one."""

    daemon_threads = True

    def __init__(self, run: RunFolder, port: int = 0, session: Session | None = None) -> None:
        self.session = session or Session(run)
        self.token = secrets.token_urlsafe(24)
        super().__init__((LOOPBACK, port), _Handler)

    @property
    def url(self) -> str:
        """The only address that answers."""
        return f"http://{LOOPBACK}:{self.server_port}/{self.token}/"


class _Handler(BaseHTTPRequestHandler):
    server: ReviewServer
    server_version = "pix2pred"
    sys_version = ""
    timeout = 60

    def do_GET(self) -> None:
        """The page, the corrections in force, or how learning is going."""
        name = self._admitted()
        session = self.server.session
        try:
            if name == "":
                page = render(load_contents(session.run), review=True).encode()
                self._send(HTTPStatus.OK, page, "text/html; charset=utf-8")
            elif name == "state":
                self._json(HTTPStatus.OK, session.state())
            elif name is not None:
                self._refuse(HTTPStatus.NOT_FOUND, "nothing here")
        except ConnectionError:  # whoever asked has gone
            self.close_connection = True
        except (ValueError, OSError) as error:  # damaged files, by hand or by a disk
            self._refuse(HTTPStatus.INTERNAL_SERVER_ERROR, str(error))

    def do_POST(self) -> None:
        """New corrections, or the wish to learn again."""
        name = self._admitted()
        if name is None:
            return
        body = self._body()
        if body is None:
            return
        session = self.server.session
        try:
            if name == "corrections":
                self._json(HTTPStatus.OK, session.correct(body))
            elif name == "learn":
                self._json(HTTPStatus.ACCEPTED, session.learn())
            else:
                self._refuse(HTTPStatus.NOT_FOUND, "nothing here")
        except StaleError as error:
            self._json(HTTPStatus.CONFLICT, {"error": str(error), **session.state()})
        except CorrectionsError as error:
            self._json(HTTPStatus.BAD_REQUEST, {"error": str(error)})
        except ConnectionError:
            self.close_connection = True
        except OSError as error:
            self._json(HTTPStatus.INTERNAL_SERVER_ERROR, {"error": f"not saved: {error}"})

    def _admitted(self) -> str | None:
        """What is asked for below the token; None, answered, when the request may not pass."""
        port = self.server.server_port
        hosts = {f"{LOOPBACK}:{port}", f"localhost:{port}"}
        origin = self.headers.get("Origin")
        site = self.headers.get("Sec-Fetch-Site", "same-origin")
        host = self.headers.get_all("Host") or []
        if len(host) != 1 or host[0] not in hosts:
            self._refuse(HTTPStatus.FORBIDDEN, "this server answers to the address it printed alone")
            return None
        if (origin is not None and origin != f"http://{host[0]}") or site not in ("same-origin", "none"):
            self._refuse(HTTPStatus.FORBIDDEN, "requests from other sites are refused")
            return None
        token, _, name = self.path.removeprefix("/").partition("/")
        if not hmac.compare_digest(token.encode(), self.server.token.encode()):
            self._refuse(HTTPStatus.FORBIDDEN, "the address lacks the token that the program printed")
            return None
        return name

    def _body(self) -> Any:
        """The JSON of a request; None, answered, when there is none of a sane size."""
        kind = self.headers.get("Content-Type", "").partition(";")[0].strip()
        length = self.headers.get("Content-Length", "")
        if kind != "application/json" or not length.isdecimal():
            self._refuse(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "expected JSON with its length")
        elif len(length) > LONGEST_LENGTH:
            self._refuse(HTTPStatus.BAD_REQUEST, "no request is that long")
        elif int(length) > MAX_BODY:
            self._refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"more than {MAX_BODY} bytes")
        else:
            try:
                body = json.loads(self.rfile.read(int(length)))
            except (ValueError, RecursionError):
                self._refuse(HTTPStatus.BAD_REQUEST, "this is no JSON")
            else:
                return {} if body is None else body
        return None

    def _json(self, status: HTTPStatus, data: Any) -> None:
        self._send(status, json.dumps(data).encode(), "application/json")

    def _refuse(self, status: HTTPStatus, why: str) -> None:
        self.close_connection = True
        self._send(status, why.encode(), "text/plain; charset=utf-8")

    def _send(self, status: HTTPStatus, content: bytes, kind: str) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        for header, value in _HEADERS.items():
            self.send_header(header, value)
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: Any) -> None:
        """Silent: the address in a log line would give the token away."""
