"""Open nodes by type, of which one is drawn now and then, so that a search leaves a region that only looks good.

Source: Xie, Müller, Holte and Imai, "Type-based exploration with multiple search queues for satisficing planning",
2014.
"""

from __future__ import annotations

import random
from typing import Generic, TypeVar

Node = TypeVar("Node")
Kind = tuple[int, int]
"""Estimates of a node."""


class ByType(Generic[Node]):
    """Draws a type, then a node of it, each as likely as any other; the same draws in every run."""

    def __init__(self) -> None:
        self._random = random.Random(0)
        self._kinds: list[Kind] = []
        self._nodes: dict[Kind, list[Node]] = {}
        self._drawn: tuple[int, int] = (0, 0)

    def __bool__(self) -> bool:
        return bool(self._kinds)

    def push(self, kind: Kind, node: Node) -> None:
        """Add ``node``."""
        if kind not in self._nodes:
            self._nodes[kind] = []
            self._kinds.append(kind)
        self._nodes[kind].append(node)

    def draw(self) -> Node:
        """A node, which stays."""
        k = self._random.randrange(len(self._kinds))
        inside = self._nodes[self._kinds[k]]
        self._drawn = k, self._random.randrange(len(inside))
        return inside[self._drawn[1]]

    def drop(self) -> None:
        """Take away the node that was drawn last."""
        k, n = self._drawn
        kind = self._kinds[k]
        inside = self._nodes[kind]
        inside[n] = inside[-1]
        inside.pop()
        if not inside:
            del self._nodes[kind]
            self._kinds[k] = self._kinds[-1]
            self._kinds.pop()
