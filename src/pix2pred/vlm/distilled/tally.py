"""Who said what: the labels a reader gave, those the large model gave, and how often the two differed.

A check is a sure answer that the large model was asked about all the same. When checks differ more often than the
reader's own probabilities and its teacher's known errors allow, the scene has drifted away from what it was taught.
"""

from __future__ import annotations

import math
import threading
from collections import Counter
from dataclasses import dataclass, field
from typing import Any, Protocol, runtime_checkable

DRIFT = 0.01
"""Differences that chance explains with a smaller probability are called drift."""
_LEAST_ERROR = 0.01
"""What is expected of readers and teachers at least: nobody is right always."""


@dataclass(frozen=True, slots=True)
class Checked:
    """A sure answer about ``atom`` that the other model was asked about as well.

    ``expected`` is the probability that the two differ, as was foreseen; ``read`` is the reader's value and ``said``
    the other's.
    """

    atom: str
    expected: float
    read: bool
    said: bool

    @property
    def differed(self) -> bool:
        """Whether the two say otherwise."""
        return self.read != self.said


@dataclass(slots=True)
class Tally:
    """Counts each atom of each look once, however often it is asked about."""

    by_reader: set[tuple[str, str]] = field(default_factory=set)
    by_model: set[tuple[str, str]] = field(default_factory=set)
    checks: dict[tuple[str, str], Checked] = field(default_factory=dict)
    questions: set[str] = field(default_factory=set)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def note(self, look: str, read: list[str], asked: list[str], checks: list[Checked], question: str | None) -> None:
        """Note the atoms of a look that were read and those that were asked, checks, and the key of the question."""
        with self._lock:
            self.by_reader |= {(look, atom) for atom in read}
            self.by_model |= {(look, atom) for atom in asked}
            self.checks |= {(look, check.atom): check for check in checks}
            self.questions |= {question} if question is not None else set()

    def checked(self, look: str, atom: str) -> bool:
        """Whether ``atom`` was checked in this look already: a scene that nothing changed is looked at again."""
        return (look, atom) in self.checks

    @property
    def differed(self) -> int:
        """Checks in which the large model said otherwise."""
        return sum(check.differed for check in self.checks.values())

    @property
    def chance(self) -> float:
        """The probability of so many differences or more if nothing has drifted."""
        rates = [max(_LEAST_ERROR, check.expected) for check in self.checks.values()]
        if not rates:
            return 1.0
        mean, count = sum(rates) / len(rates), len(rates)
        fewer = sum(math.comb(count, k) * mean**k * (1 - mean) ** (count - k) for k in range(self.differed))
        return max(0.0, 1 - fewer)

    @property
    def drifted(self) -> bool:
        """Whether the reader differs from the large model more often than can be chance."""
        return self.chance < DRIFT

    def as_dict(self) -> dict[str, Any]:
        """JSON-compatible counts, in all and by the word of the atoms, and the checks in which the two differed."""
        return {
            "by_reader": len(self.by_reader),
            "by_model": len(self.by_model),
            "questions": len(self.questions),
            "checked": len(self.checks),
            "differed": self.differed,
            "drifted": self.drifted,
            "words": self._by_word(),
            "differences": [
                {"picture": look.partition("|")[0], "atom": atom, "read": check.read, "said": check.said}
                for (look, atom), check in sorted(self.checks.items())
                if check.differed
            ],
        }

    def _by_word(self) -> dict[str, dict[str, int]]:
        counted = {
            "by_reader": self.by_reader,
            "by_model": self.by_model,
            "checked": self.checks,
            "differed": [key for key, check in self.checks.items() if check.differed],
        }
        counts = {what: Counter(atom.partition("(")[0] for _, atom in atoms) for what, atoms in counted.items()}
        words = sorted({word for count in counts.values() for word in count})
        return {word: {what: count[word] for what, count in counts.items()} for word in words}

    def line(self) -> str:
        """One sentence for people."""
        count = len(self.by_reader) + len(self.by_model)
        text = (
            f"{len(self.by_reader)} of {count} labels read, {len(self.by_model)} asked of the large model in "
            f"{len(self.questions)} questions; {len(self.checks)} sure ones checked, {self.differed} differed"
        )
        if self.drifted:
            text += ": more than chance allows. The scene has changed; distil again with 'pix2pred distil --resume'"
        return text


@runtime_checkable
class Tallied(Protocol):
    """A model that shares its work with another and counts who did what."""

    @property
    def tally(self) -> Tally:
        """The counts so far."""
        ...
