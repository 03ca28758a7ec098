"""ViLa with demonstrations in the prompt, as many as a suite says fit."""

from __future__ import annotations

from pix2pred.approaches.vila import ViLa

VILA_FEWSHOT = ViLa("vila-fewshot", shows_demos=True)
