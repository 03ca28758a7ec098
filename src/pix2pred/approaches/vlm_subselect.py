"""The model itself chooses: it is asked for the critical predicates only, and all it names are kept (method 9).

Hill climbing then chooses among the feature predicates, with the model's choice given.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from pix2pred.approaches.approach import Composition
from pix2pred.learning import LearningSettings, Selection
from pix2pred.pipeline import climb, whole_pool
from pix2pred.settings import Settings
from pix2pred.structs import FromVLM, Predicate, TruthTable
from pix2pred.system.progress import Progress, silent


def climb_from_visual(
    table: TruthTable, settings: LearningSettings, progress: Progress = silent, pinned: Sequence[Predicate] = ()
) -> Selection:
    """Hill climbing over feature predicates, every visual one among the initial ones."""
    visual = tuple(c.predicate for c in table.pool if isinstance(c.predicate.source, FromVLM))
    features = tuple(c for c in table.pool if c.predicate not in visual)
    given = TruthTable((*table.initial, *visual), features, table.demos)
    selection = climb(given, settings, progress, [p for p in pinned if p not in visual])
    return replace(selection, selected=(*visual, *selection.selected), pinned=tuple(pinned))


def ask_specifically(settings: Settings) -> Settings:
    """The same settings with the prompt that asks for the critical predicates only."""
    return settings.model_copy(update={"proposal": settings.proposal.model_copy(update={"variant": "specific"})})


VLM_SUBSELECT = Composition("vlm-subselect", whole_pool, climb_from_visual, needs_model=True, adjust=ask_specifically)
