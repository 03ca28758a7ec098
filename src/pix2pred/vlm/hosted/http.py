"""The HTTP client below all providers: it hears what headers say, and reads no body without an end.

Bodies are asked for uncompressed. A server that compresses all the same is understood when it uses gzip or deflate,
and what comes out is bounded too.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import AsyncIterator, Callable
from contextvars import ContextVar
from typing import Any

import httpx2

Heard = Callable[[dict[str, str]], None]
"""Told the headers of every good response, names in lower case."""

MOST_BYTES = 32 << 20
"""Of one body, as sent and unpacked: 8,000 tokens with five alternatives each are five megabytes."""
_SECONDS, _SECONDS_TO_CONNECT = 600.0, 10.0
"""Bounds below those of the flow settings, which end earlier; a server that takes longer to connect is not there."""
ANSWERED: ContextVar[list[int] | None] = ContextVar("answered", default=None)
"""Where the status of every response is noted while one question is sent, for whoever has to tell why it failed."""
_UNNEEDED = ("id", "created", "usage", "object", "model", "system_fingerprint", "service_tier")
"""Fields of a chat completion that are left out when they have another form than the protocol says."""
_FORMS: dict[str, type | tuple[type, ...]] = {"created": int, "usage": dict}
_LATEST = 1 << 40
"""Seconds since 1970, of what can be a date at all."""


class OversizeError(httpx2.TransportError):
    """A body larger than any answer."""


class ElsewhereError(httpx2.TransportError):
    """The server sends questions to another address, which is its message: questions hold pictures and a key."""


class NoDocumentError(httpx2.TransportError):
    """A good status with a body that is no JSON: a page, nothing, or anything. The message says which."""


def http_client(heard: Heard) -> httpx2.AsyncClient:
    """A client that tells ``heard`` what good responses say in their headers."""

    async def listen(response: httpx2.Response) -> None:
        if response.status_code < 400:  # failures bring their own waiting time
            heard({name.lower(): value for name, value in response.headers.items()})

    return httpx2.AsyncClient(
        transport=_Bounded(httpx2.AsyncHTTPTransport()),
        headers={"accept-encoding": "identity"},
        timeout=httpx2.Timeout(_SECONDS, connect=_SECONDS_TO_CONNECT),
        event_hooks={"response": [listen]},
    )


class _Bounded(httpx2.AsyncBaseTransport):
    """Reads every body whole, up to its bound, and hands on what the client libraries can read."""

    def __init__(self, below: httpx2.AsyncBaseTransport) -> None:
        self._below = below

    async def handle_async_request(self, request: httpx2.Request) -> httpx2.Response:
        request.headers["accept-encoding"] = "identity"
        response = await self._below.handle_async_request(request)
        if (answered := ANSWERED.get()) is not None:
            answered.append(response.status_code)
        try:
            packed = response.headers.get("content-encoding", "identity").strip().lower()
            content = await _whole(response.stream, packed)
        finally:
            await response.aclose()
        _check(response, content, request.url)
        dropped = ("content-encoding", "content-length", "transfer-encoding")
        headers = [(name, value) for name, value in response.headers.multi_items() if name.lower() not in dropped]
        return httpx2.Response(
            response.status_code, headers=headers, content=usual(content), extensions=response.extensions
        )

    async def aclose(self) -> None:
        await self._below.aclose()


def _place(location: str, asked: httpx2.URL) -> str:
    """The whole address that ``location``, which may be a path alone, names, without what follows a ``?``."""
    try:
        return str(asked.join(location).copy_with(query=None, fragment=None)) if location else ""
    except httpx2.InvalidURL:
        return location.partition("?")[0]


def _check(response: httpx2.Response, content: bytes, asked: httpx2.URL) -> None:
    """Raise what says that this is no answer of a model's server, in place of what libraries make of it."""
    if 300 <= response.status_code < 400:
        raise ElsewhereError(_place(response.headers.get("location", ""), asked) or "nowhere")
    begin = content.lstrip()[:1]
    if response.status_code < 300 and begin not in (b"{", b"["):
        kind = "a web page" if begin == b"<" else "an empty answer" if not begin else "no JSON"
        raise NoDocumentError(kind)


async def _whole(stream: Any, packed: str) -> bytes:
    """The body, unpacked. Raises ``OversizeError``, or ``httpx2.DecodingError`` for a packing nobody asked for."""
    if packed not in ("identity", "", "gzip", "x-gzip", "deflate"):
        raise httpx2.DecodingError(f"the server packs its answer with {packed[:20]}, which was not asked for")
    unpacking = None if packed in ("identity", "") else zlib.decompressobj(zlib.MAX_WBITS | 32)
    pieces: AsyncIterator[bytes] = aiter(stream)
    read, made = 0, bytearray()
    async for piece in pieces:
        read += len(piece)
        if unpacking is None:
            made += piece
        else:
            try:
                made += unpacking.decompress(piece, MOST_BYTES + 1 - len(made))
            except zlib.error as error:
                raise httpx2.DecodingError("the packed answer is damaged") from error
        if read > MOST_BYTES or len(made) > MOST_BYTES:
            raise OversizeError(f"the answer is larger than {MOST_BYTES >> 20} MB")
    return bytes(made)


def usual(content: bytes) -> bytes:
    """A chat completion without the unneeded fields that have an unusual form; everything else as it is."""
    if content.lstrip()[:1] != b"{" or b'"choices"' not in content:
        return content
    try:
        document = json.loads(content)
    except (ValueError, RecursionError):
        return content
    mended = _mended(document.get("choices"))
    odd = [name for name in _UNNEEDED if name in document and not _has_form(name, document[name])]
    if not odd and not mended and "id" in document and "created" in document:
        return content
    kept = {name: value for name, value in document.items() if name not in odd}
    return json.dumps({"id": "", "created": 0, "object": "chat.completion", "model": ""} | kept).encode()


def _mended(choices: Any) -> bool:
    """Make reasons to finish that say nothing absent, and number the choices; whether anything was changed."""
    changed = False
    for number, choice in enumerate(choices if isinstance(choices, list) else ()):
        if isinstance(choice, dict):
            reason = choice.get("finish_reason")
            usual_ones = {"index": number, "finish_reason": reason if reason and isinstance(reason, str) else None}
            changed |= any(choice.get(key, ...) != value for key, value in usual_ones.items())
            choice |= usual_ones
    return changed


def _has_form(name: str, value: Any) -> bool:
    if name == "created" and not (isinstance(value, int) and 0 <= value < _LATEST):
        return False
    if name == "usage" and isinstance(value, dict):
        counts = ("prompt_tokens", "completion_tokens", "total_tokens")
        return all(isinstance(value.get(c, 0), int) and 0 <= value.get(c, 0) < _LATEST for c in counts)
    return isinstance(value, _FORMS.get(name, str))
