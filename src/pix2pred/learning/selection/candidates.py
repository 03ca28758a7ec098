"""Which candidates are worth scoring: one for every distinct column of labels (method 6.5, item 4)."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.learning.operators.learner import OperatorModel


def distinct_candidates(model: OperatorModel, pinned: Sequence[int], static_demos: int) -> dict[int, list[int]]:
    """The cheapest (then first) candidate of every column of labels, with the others that share the column.

    Left out are candidates whose labels make no sense, and predicates that never change and tell the objects of fewer
    than ``static_demos`` demonstrations apart, unless they are ``pinned``.
    """
    data = model.data
    by_column: dict[tuple[object, ...], list[int]] = {}
    everything = range(data.initial, len(data.predicates))
    candidates = [p for p in everything if p in pinned or _is_eligible(model, p, static_demos)]
    for p in sorted(candidates, key=lambda p: (p not in pinned, model.price(p))):
        by_column.setdefault(data.column(p), []).append(p)
    return {members[0]: members[1:] for members in sorted(by_column.values())}


def _is_eligible(model: OperatorModel, p: int, static_demos: int) -> bool:
    """Whether a candidate's labels make sense, and it is more than a name for objects of one demonstration.

    A predicate that never changes can only tell objects apart. What it says of a demonstration's objects is one
    observation, however many states repeat it, so it has to do so within several demonstrations.
    """
    if p in model.unreliable:
        return False
    return bool(model.data.changing(p)) or model.data.demos_divided(p) >= min(static_demos, len(model.data.demos))
