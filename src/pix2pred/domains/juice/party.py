"""Juice for many: a low buffet with up to five juicers, and cups under their valves or aside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pix2pred.domains.home.drawing.fixtures import table_size
from pix2pred.domains.home.places import Region, region_middle
from pix2pred.domains.home.settling import rise_of, settled
from pix2pred.domains.home.world import SCENERY, Body, Thing, World
from pix2pred.domains.juice.scenes import cup_at, fruit_in, squeezed_at
from pix2pred.domains.seeds import look

Rng = np.random.Generator

JUICER_PLACES = ((1.00, 0.0), (1.50, -0.42), (1.50, 0.42), (1.00, -0.66), (1.00, 0.66))
"""Three juicers in front and two behind, at which the raised hand's camera looks between those in front (metres)."""

FREE_PLACES = (
    (0.77, 0.24), (0.77, -0.24), (0.77, 0.46), (0.77, -0.46), (1.17, 0.20), (1.17, -0.20),
    (1.15, 0.46), (1.15, -0.46), (1.25, 0.70), (1.25, -0.70),
)  # fmt: skip
"""Where vessels and fruit stand that are under no valve; nothing blocks that camera's view of them."""


@dataclass(frozen=True, slots=True)
class PartyJuicer:
    """A juicer: what is in its hopper or lies squeezed before it, whether the lid stands open, and where it stands.

    ``place`` is the number of one of the buffet's places.
    """

    inside: str | None = None
    squeezed: str | None = None
    opened: bool = False
    place: int = 0


@dataclass(frozen=True, slots=True)
class PartyCup:
    """A cup or bowl: its kind, what it holds, and the number of the juicer and the region it stands in, if any."""

    name: str
    kind: str
    contents: Sequence[str] = ()
    under: tuple[int, Region] | None = None


@dataclass(frozen=True, slots=True)
class Board:
    """What everything stands on: its kind, its middle, and where vessels and fruit stand that are under no valve.

    ``bowls`` and ``fruits`` have places of their own, where there are any.
    """

    kind: str
    middle: float
    free: Sequence[tuple[float, float]]
    bowls: Sequence[tuple[float, float]] = ()
    fruits: Sequence[tuple[float, float]] = ()


BUFFET = Board("buffet", 1.21, FREE_PLACES)
BANQUET = Board(
    "banquet",
    1.07,
    free=(*FREE_PLACES[:4], *FREE_PLACES[6:]),
    bowls=(*((0.54, 0.24 * k) for k in range(-3, 4)), *FREE_PLACES[4:6]),
    fruits=((0.66, 0.12), (0.66, -0.12), (0.66, 0.36), (0.66, -0.36), (0.66, 0.60), (0.66, -0.60)),
)
"""A deeper one, with room for a row of bowls and for fruit before the juicers."""


def lay_out(
    machines: Sequence[PartyJuicer],
    vessels: Sequence[PartyCup],
    fruits: Sequence[str],
    style: str,
    rng: Rng,
    board: Board = BUFFET,
) -> World:
    """The robot before a board with these machines, vessels and fruits, everything else drawn from ``rng``."""
    table = Thing("buffet", SCENERY, board.kind, look(rng), (board.middle, 0.0, 0.0))
    top = table_size(table).height
    shell = look(rng)
    juicers = [
        Thing(f"juicer{k + 1}", "juicer", "juicer", shell, (*JUICER_PLACES[m.place], top), opened=m.opened)
        for k, m in enumerate(machines)
    ]
    things = [table, *juicers]
    for juicer, machine in zip(juicers, machines, strict=True):
        things += [fruit_in(juicer, machine.inside, 0, rng)] if machine.inside else []
        things += [squeezed_at(juicer, machine.squeezed, 0, rng)] if machine.squeezed else []
    free = _shuffled(board.free, rng)
    for_bowls, for_fruits = (_shuffled(own, rng) if own else free for own in (board.bowls, board.fruits))
    for vessel in vessels:
        if vessel.under:
            x, y, _ = region_middle(juicers[vessel.under[0]], vessel.under[1])
        else:
            x, y = (for_bowls if vessel.kind == "bowl" and for_bowls else free).pop()
        things.append(cup_at(vessel.name, vessel.kind, vessel.contents, (_near(x, rng), _near(y, rng), top), rng))
    for name in fruits:
        made, (x, y) = Thing(name, "movable_object", name, look(rng)), for_fruits.pop()
        things.append(replace(made, at=(_near(x, rng), _near(y, rng), top + rise_of(made) + 0.003)))
    return settled(World(tuple(things), Body.ROBOT, look(rng), style), 0.8)


def _shuffled(places: Sequence[tuple[float, float]], rng: Rng) -> list[tuple[float, float]]:
    return [places[i] for i in rng.permutation(len(places))]


def _near(value: float, rng: Rng) -> float:
    return value + float(rng.uniform(-0.012, 0.012))
