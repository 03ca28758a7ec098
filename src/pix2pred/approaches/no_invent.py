"""No invention: operators over the given predicates alone, with the same learner and pruning."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.approaches.approach import Composition
from pix2pred.approaches.no_subselect import keep_all
from pix2pred.pipeline import Pool, Progress, Settings, silent
from pix2pred.structs import Demo, Vocabulary
from pix2pred.vlm import VLM


def empty_pool(
    vocabulary: Vocabulary, demos: Sequence[Demo], vlm: VLM, settings: Settings, progress: Progress = silent
) -> Pool:
    """No candidates."""
    return Pool(())


NO_INVENT = Composition("no-invent", empty_pool, keep_all)
