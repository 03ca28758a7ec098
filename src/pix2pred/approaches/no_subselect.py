"""No selection: every candidate is kept, so operators are learned over all of them."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.approaches.approach import Composition
from pix2pred.learning import LearningSettings, Selection, learn_operators
from pix2pred.pipeline import whole_pool
from pix2pred.structs import Predicate, TruthTable
from pix2pred.system.progress import Progress, Stage, silent


def keep_all(
    table: TruthTable, settings: LearningSettings, progress: Progress = silent, pinned: Sequence[Predicate] = ()
) -> Selection:
    """Every candidate that is true at least once, and the operators learned with all of them."""
    everything = tuple(c.predicate for c in table.candidates())
    progress(Stage.SELECT, len(everything), len(everything), "all are kept")
    return Selection(everything, (), learn_operators(table, settings), (), (), 0, 0, 0, 0, tuple(pinned))


NO_SUBSELECT = Composition("no-subselect", whole_pool, keep_all)
