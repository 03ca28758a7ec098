"""Settings of the published learner: what most tests of operators and selection are about."""

from __future__ import annotations

from pix2pred.learning import LearningSettings


def published(**chosen: object) -> LearningSettings:
    """The published learner with other settings ``chosen``."""
    return LearningSettings.model_validate({"operators": "cluster-and-intersect", **chosen})
