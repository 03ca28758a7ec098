"""A world model as a few lines of HTML, for notebooks: its verdict, its predicates and a card per operator."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.report.page import environment
from pix2pred.runs.verdict import spoken
from pix2pred.structs import WorldModel


def model_cards(model: WorldModel, verdict: Sequence[str]) -> str:
    """HTML without scripts and styles from elsewhere; everything in it is escaped."""
    return environment().get_template("cards.html.j2").render(model=model, verdict=verdict, spoken=spoken)
