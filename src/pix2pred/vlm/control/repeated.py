"""What of a question was sent before, from its beginning on: what a provider's prompt cache can hold."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

from pix2pred.vlm.request import Part, Request

KEPT = 64
"""Questions back: caches are kept for minutes, and a question shares most with those just before it."""


@dataclass(frozen=True, slots=True)
class Beginning:
    """The longest beginning that a question shares with an earlier one: characters of text, and whole parts."""

    characters: int = 0
    parts: tuple[Part, ...] = ()


@dataclass(slots=True)
class Repeated:
    """Remembers the last questions."""

    _sent: deque[Sequence[Part]] = field(default_factory=lambda: deque(maxlen=KEPT))

    def beginning(self, request: Request) -> Beginning:
        """What ``request`` shares with one of the last questions, which it then joins."""
        found = max((_shared(request.parts, earlier) for earlier in self._sent), key=_size, default=Beginning())
        self._sent.append(request.parts)
        return found


def _size(beginning: Beginning) -> tuple[int, int]:
    return len(beginning.parts), beginning.characters


def _shared(parts: Sequence[Part], earlier: Sequence[Part]) -> Beginning:
    characters = 0
    for number, (part, old) in enumerate(zip(parts, earlier, strict=False)):
        if part != old:
            if isinstance(part, str) and isinstance(old, str):
                characters += _common(part, old)
            return Beginning(characters, tuple(parts[:number]))
        characters += len(part) if isinstance(part, str) else 0
    return Beginning(characters, tuple(parts[: len(earlier)]))


def _common(a: str, b: str) -> int:
    """The length of the longest common beginning, by halving: comparing slices is fast, characters are not."""
    low, high = 0, min(len(a), len(b))
    while low < high:
        middle = (low + high + 1) // 2
        low, high = (middle, high) if a[low:middle] == b[low:middle] else (low, middle - 1)
    return low
