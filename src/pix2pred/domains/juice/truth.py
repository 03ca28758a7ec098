"""Ground truth of visual words, for tests, for training the reader, and for naming failures once they happened."""

from __future__ import annotations

from collections.abc import Mapping

from pix2pred.domains.home.drawing.vessels import VESSELS
from pix2pred.domains.home.places import Region, hopper_contents, in_hopper, in_region
from pix2pred.domains.home.world import World
from pix2pred.domains.juice.rules import juice_of
from pix2pred.domains.words import Concept, TrueWords

CONCEPTS: Mapping[str, Concept] = {
    "is_cup": Concept(("container",), lambda w, c: VESSELS[w.thing(c).kind].cup),
    "is_plastic": Concept(("container",), lambda w, c: VESSELS[w.thing(c).kind].plastic),
    "empty": Concept(("container",), lambda w, c: not w.thing(c).contents),
    "container_held": Concept(("container",), lambda w, c: w.holding == c),
    "juice_region": Concept(("container", "juicer"), lambda w, c, j: in_region(w, c, j, Region.JUICE)),
    "waste_region": Concept(("container", "juicer"), lambda w, c, j: in_region(w, c, j, Region.WASTE)),
    "outside": Concept(("movable_object",), lambda w, m: not any(in_hopper(w, m, j.name) for j in w.of_type("juicer"))),
    "fruit_held": Concept(("movable_object",), lambda w, m: w.holding == m),
    "squeezed": Concept(("movable_object",), lambda w, m: w.thing(m).squeezed),
    "inside": Concept(("movable_object", "juicer"), in_hopper),
    "juice_in_cup": Concept(("movable_object", "container"), juice_of),
    "lid_closed": Concept(("juicer",), lambda w, j: not w.thing(j).opened),
    "functional": Concept(("juicer",), lambda w, j: w.thing(j).powered),
    "loaded": Concept(("juicer",), lambda w, j: bool(hopper_contents(w, j))),
}

concept_value = TrueWords(CONCEPTS, World.types).value
