"""ViLa without demonstrations: the model plans from the pictures of the initial state."""

from __future__ import annotations

from pix2pred.approaches.vila import ViLa

VILA_PURE = ViLa("vila-pure", shows_demos=False)
