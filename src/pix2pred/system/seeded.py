"""Chance that words decide: the same on every machine, in every process and in any order of asking."""

from __future__ import annotations

import hashlib

_BYTES = 7
"""How much of the digest is used: a little more than a float holds."""


def draw(*words: object) -> float:
    """A number, evenly spread over [0, 1), that the texts of ``words`` and their order alone decide."""
    text = "|".join(map(str, words))
    digest = hashlib.sha256(text.encode()).digest()[:_BYTES]
    return int.from_bytes(digest) / float(1 << 8 * _BYTES)
