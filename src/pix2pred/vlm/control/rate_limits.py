"""What providers say in headers about how soon to come back."""

from __future__ import annotations

import re
from collections.abc import Mapping

_PART = re.compile(r"(\d+(?:\.\d+)?)(ms|h|m|s)")
_SECONDS = {"ms": 0.001, "s": 1.0, "m": 60.0, "h": 3600.0}
_KINDS = ("requests", "tokens", "input-tokens", "output-tokens")


def pause_after(headers: Mapping[str, str], now: float) -> float:
    """Seconds to wait before the next request, from the headers of an answer; 0 when none is asked for.

    A provider that says nothing remains of an allowance also says when it is filled again: OpenAI and those who copy it
    as a duration (``x-ratelimit-reset-requests: 6m0s``), Anthropic as a date; ``now`` is seconds since 1970.
    """
    waits = [0.0]
    for prefix in ("x-ratelimit-", "anthropic-ratelimit-"):
        for kind in _KINDS:
            order = (f"{prefix}{kind}-{{}}", f"{prefix}{{}}-{kind}")
            remaining = next((headers[o.format("remaining")] for o in order if o.format("remaining") in headers), "")
            reset = next((headers[o.format("reset")] for o in order if o.format("reset") in headers), "")
            if remaining.strip() == "0":
                waits.append(seconds(reset, now))
    return max(waits)


def retry_after(headers: Mapping[str, str], now: float) -> float | None:
    """Seconds a refusing server asks to wait (``retry-after-ms``, ``retry-after``), or ``None``."""
    if (milliseconds := headers.get("retry-after-ms", "")).strip().isdigit():
        return int(milliseconds) / 1000
    text = headers.get("retry-after")
    return None if text is None else seconds(text, now)


def seconds(text: str, now: float) -> float:
    """``1.5``, ``6m0s``, ``20ms`` or a date, as seconds from ``now``; 0 for anything else."""
    text = text.strip()
    try:
        return max(0.0, float(text))
    except ValueError:
        pass
    parts = _PART.findall(text)
    if parts and "".join(n + unit for n, unit in parts) == text:
        return sum(float(n) * _SECONDS[unit] for n, unit in parts)
    return max(0.0, _timestamp(text, now) - now)


def _timestamp(text: str, otherwise: float) -> float:
    from datetime import datetime
    from email.utils import parsedate_to_datetime

    for parse in (datetime.fromisoformat, parsedate_to_datetime):
        try:
            return parse(text).timestamp()
        except (ValueError, TypeError, OverflowError):
            continue
    return otherwise
