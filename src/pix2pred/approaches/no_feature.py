"""No feature predicates: labels of pictures alone."""

from __future__ import annotations

from pix2pred.approaches.approach import Composition
from pix2pred.pipeline import visual_pool

NO_FEATURE = Composition("no-feature", visual_pool)
