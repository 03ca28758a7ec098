"""No invention: operators over the given predicates alone, with the same learner and pruning."""

from __future__ import annotations

from pix2pred.approaches.approach import Composition
from pix2pred.approaches.no_subselect import keep_all
from pix2pred.pipeline import LearningProblem, Pool


def empty_pool(problem: LearningProblem) -> Pool:
    """No candidates."""
    return Pool(())


NO_INVENT = Composition("no-invent", empty_pool, keep_all)
