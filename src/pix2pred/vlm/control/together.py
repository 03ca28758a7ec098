"""Asking many questions at once: the one place where threads that ask are started.

Votes are asked inside batches, batches inside states, states inside demonstrations. Whatever is asked together goes
through one ``Together``, so that its number of places bounds them all: work that waits for parts of its own gives its
place to one of them, and the deepest parts begin first, so that what was begun is finished before more is begun.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from heapq import heappop, heappush
from typing import Any, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")

PLACES = 8
"""Questions at once where nothing else is said; the smallest paid allowances of the providers bear it."""


@dataclass(eq=False, slots=True)
class _Group:
    """Pieces of work that were asked for together; ``closed`` when no more of them are to begin."""

    closed: bool = False


@dataclass(eq=False, slots=True)
class _Part:
    """One piece of work and what became of it."""

    work: Callable[[], Any]
    group: _Group
    depth: int
    begun: bool = False
    done: bool = False
    results: list[Any] = field(default_factory=list)
    error: BaseException | None = None


class Together:
    """Does pieces of work at the same time, at most ``places`` at once, however they are nested."""

    def __init__(self, places: int = PLACES) -> None:
        self._free = places
        self._going_on = 0
        self._waiting: list[tuple[int, int, _Part]] = []
        self._count = 0
        self._changed = threading.Condition()
        self._here = threading.local()

    def map(self, work: Callable[[Item], Result], items: Sequence[Item]) -> Iterator[Result]:
        """``work`` of every item, in the order of ``items``; each result as soon as those before it are there.

        The thread that asks does the work of a single item itself. After an error no further item is begun, and the
        first error in the order of ``items`` is raised once those under way have ended.
        """
        if len(items) <= 1:
            yield from map(work, items)
            return
        group, depth = _Group(), self._depth() + 1
        parts = [_Part(lambda item=item: work(item), group, depth) for item in items]  # type: ignore[misc]
        with self._changed:
            for part in parts:
                self._count += 1
                heappush(self._waiting, (-depth, self._count, part))
            self._begin()
        try:
            for part in parts:
                self._wait_for(part)
                if part.error is not None:
                    group.closed = True
                    for other in parts:
                        self._wait_for(other)
                    raise part.error
                yield part.results[0]
        finally:
            group.closed = True

    def _depth(self) -> int:
        """How deep inside other work this thread is; only threads of this object have a place to give up."""
        depth: int = getattr(self._here, "depth", 0)
        return depth

    def _wait_for(self, part: _Part) -> None:
        """Wait until ``part`` has ended, or can no longer begin; a place is given up meanwhile and taken again."""

        def ended() -> bool:
            return part.done or (part.group.closed and not part.begun)

        with self._changed:
            if ended():
                return
            if self._depth() == 0:
                self._changed.wait_for(ended)
                return
            self._free += 1
            self._changed.notify_all()  # somebody whose parts have ended may be waiting for a place to go on
            self._begin()
            self._changed.wait_for(ended)
            self._going_on += 1  # before anything new begins
            self._changed.wait_for(lambda: self._free > 0)
            self._going_on -= 1
            self._free -= 1

    def _begin(self) -> None:
        """Start as much work as there are places for; the lock is held."""
        while self._free > self._going_on and self._waiting:
            part = heappop(self._waiting)[2]
            if not part.group.closed:
                part.begun = True
                self._free -= 1
                threading.Thread(target=self._run, args=(part,), name="pix2pred-asking", daemon=True).start()

    def _run(self, part: _Part) -> None:
        self._here.depth = part.depth
        try:
            part.results.append(part.work())
        except BaseException as error:  # raised where the result is asked for
            part.error = error
            part.group.closed = True
        with self._changed:
            part.done = True
            self._free += 1
            self._changed.notify_all()
            self._begin()
