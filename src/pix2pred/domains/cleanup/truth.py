"""Ground truth of visual words, for tests, for training the reader, and for naming failures once they happened."""

from __future__ import annotations

from collections.abc import Mapping

from pix2pred.domains.home.places import in_bin, on_floor, on_table, things_in, things_on
from pix2pred.domains.home.world import World
from pix2pred.domains.words import Concept, TrueWords

CONCEPTS: Mapping[str, Concept] = {
    "is_eraser": Concept(("movable_object",), lambda w, m: w.thing(m).kind == "eraser"),
    "on_floor": Concept(("movable_object",), on_floor),
    "held": Concept(("movable_object",), lambda w, m: w.holding == m),
    "on_table": Concept(("movable_object", "table"), on_table),
    "in_bin": Concept(("movable_object", "trash_can"), in_bin),
    "clear": Concept(("table",), lambda w, t: not things_on(w, t)),
    "wiped": Concept(("table",), lambda w, t: not w.thing(t).strokes),
    "bin_empty": Concept(("trash_can",), lambda w, c: not things_in(w, c)),
    "narrow": Concept(("trash_can",), lambda w, c: w.thing(c).kind == "narrow_bin"),
}

concept_value = TrueWords(CONCEPTS, World.types).value
