"""Preconditions of many operators as arrays, so that numpy looks them up together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pix2pred.planning.strips import bits

Places = NDArray[np.intp]


def by_width(masks: Sequence[int]) -> list[tuple[int, list[Places]]]:
    """Sets of facts, ordered by their sizes: where those of one size begin, and as many columns of facts.

    Empty sets are left out.
    """
    found: list[tuple[int, list[Places]]] = []
    begin = 0
    while begin < len(masks):
        width = masks[begin].bit_count()
        end = begin
        while end < len(masks) and masks[end].bit_count() == width:
            end += 1
        if width:
            facts = np.fromiter((f for mask in masks[begin:end] for f in bits(mask)), np.intp).reshape(-1, width)
            found.append((begin, [np.ascontiguousarray(column) for column in facts.T]))
        begin = end
    return found
