"""The full method: visual and feature candidates, hill climbing on J."""

from __future__ import annotations

from pix2pred.approaches.approach import Composition
from pix2pred.pipeline import whole_pool

OURS = Composition("ours", whole_pool)
