"""Which pictures of a random home world a reader is trained on."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pix2pred.domains.home.cameras import camera_names, picture
from pix2pred.domains.home.world import World
from pix2pred.structs import Picture

_CHOOSING = 13
"""The second number of the seed by which cameras are left out."""


def some_pictures(world: World, shares: Mapping[str, float]) -> list[Picture]:
    """What a person sees, or the hand camera's picture and some of the others, by the world's own seed.

    ``shares`` says how often a camera's picture is taken; one that is not in it takes none.
    """
    rng = np.random.default_rng(np.random.SeedSequence((world.room, _CHOOSING)))
    chosen = [n for n in camera_names(world) if n in ("head", "hand_color") or rng.random() < shares.get(n, 0.0)]
    return [picture(world, name) for name in chosen]
