"""No visual predicates: object features alone (after Silver et al., 2023, with the noise-aware operator learner)."""

from __future__ import annotations

from pix2pred.approaches.approach import Composition
from pix2pred.pipeline import feature_pool

NO_VISUAL = Composition("no-visual", feature_pool)
