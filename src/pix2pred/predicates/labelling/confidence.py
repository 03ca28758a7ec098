"""How sure a model was of a value, from the probabilities of its tokens."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pix2pred.structs import Label
from pix2pred.vlm import Token


def probability(tokens: Sequence[Token], place: int, value: Label) -> float | None:
    """The probability of ``value`` among the three, at the token with which the value's word begins.

    ``place`` is where the word begins in the answer, whose text the tokens make up. ``None`` when no likely token
    there begins one of the three words.
    """
    start = 0
    for token in tokens:
        if start <= place < start + len(token.text):
            return _share(token, token.text[: place - start], value)
        start += len(token.text)
    return None


def _share(token: Token, before: str, value: Label) -> float | None:
    masses = dict.fromkeys(Label, 0.0)
    for text, logprob in dict(token.logprobs).items():
        begun = text.removeprefix(before).strip(" *`\"'").lower()
        for candidate in Label:
            word: str = candidate.word
            if begun and (word.startswith(begun) or begun.startswith(word)):
                masses[candidate] += math.exp(min(0.0, logprob))
    total = sum(masses.values())
    return masses[value] / total if total > 0 and masses[value] > 0 else None
