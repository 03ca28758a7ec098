"""Which skill does what, and when the given predicates hold (method 10.4)."""

from __future__ import annotations

from pix2pred.domains.cleanup import skills
from pix2pred.domains.cleanup import vocabulary as words
from pix2pred.domains.home.episode import Rules
from pix2pred.domains.home.places import in_bin

RULES = Rules(
    words.TYPES,
    {
        words.PICK_FROM_TOP: skills.pick_from_top,
        words.PLACE_INSIDE: skills.place_inside,
        words.PICK_FROM_FLOOR: skills.pick_from_floor,
        words.WIPE: skills.wipe,
        words.DUMP: skills.dump,
    },
    {
        words.HOLDING: lambda w, robot, m: w.holding == m,
        words.HAND_EMPTY: lambda w, robot: w.holding is None,
        words.INSIDE_CONTAINER: in_bin,
        words.WIPED: lambda w, table: not w.thing(table).strokes,
    },
)
