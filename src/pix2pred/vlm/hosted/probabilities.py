"""Probabilities of tokens as providers tell them."""

from __future__ import annotations

import math
from typing import Any

from pix2pred.vlm.request import Token


def tokens_of(logprobs: Any, text: str) -> tuple[Token, ...]:
    """Tokens with their own probability first; empty when they are not there, absurd, or do not make up the text."""
    try:
        tokens = [
            Token(str(item["token"]), tuple(_logprob(t) for t in (item, *(item.get("top_logprobs") or ()))))
            for item in (logprobs if isinstance(logprobs, list) else ())
        ]
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError):
        return ()
    return tuple(tokens) if "".join(t.text for t in tokens) == text else ()


def _logprob(token: Any) -> tuple[str, float]:
    """A token's text and the logarithm of its probability. Raises ``ValueError`` for what cannot be one."""
    value = token["logprob"]
    if isinstance(value, bool) or not isinstance(value, int | float) or math.isnan(value) or value > 0:
        raise ValueError("no logarithm of a probability")
    return str(token["token"]), float(value)
