"""Which skill does what, and when the given predicates hold (method 10.5)."""

from __future__ import annotations

from functools import partial

from pix2pred.domains.home.episode import Rules
from pix2pred.domains.home.places import Region, in_hopper
from pix2pred.domains.home.world import World
from pix2pred.domains.juice import skills
from pix2pred.domains.juice import vocabulary as words


def juice_of(world: World, fruit: str, container: str) -> bool:
    """Whether the juice of a squeezed fruit is in a vessel; juice is known by the kind of its fruit."""
    thing = world.thing(fruit)
    return thing.squeezed and thing.kind in world.thing(container).contents


RULES = Rules(
    words.TYPES,
    {
        words.PICK_CONTAINER: skills.take,
        words.PICK_MOVABLE: skills.pick_movable,
        words.PLACE_IN_WASTE_REGION: partial(skills.place_in_region, region=Region.WASTE),
        words.PLACE_IN_JUICE_REGION: partial(skills.place_in_region, region=Region.JUICE),
        words.PLACE_INSIDE: skills.place_inside,
        words.POUR: skills.pour,
        words.CLOSE_LID: skills.close_lid,
        words.RUN: skills.run_machine,
    },
    {
        words.HOLDING_CONTAINER: lambda w, robot, c: w.holding == c,
        words.HOLDING_OBJ: lambda w, robot, m: w.holding == m,
        words.HAND_EMPTY: lambda w, robot: w.holding is None,
        words.JUICE_IN_CUP: juice_of,
        words.EMPTY: lambda w, c: not w.thing(c).contents,
        words.INSIDE: in_hopper,
    },
)
