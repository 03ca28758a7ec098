"""Where juice scenes start: a juicer on a counter, cups in their regions or aside, a bowl, fruit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pix2pred.domains.home.drawing.fixtures import table_size
from pix2pred.domains.home.drawing.vessels import HOPPER_BOTTOM, RIND_PLACE
from pix2pred.domains.home.places import Place, Region, apart, region_middle
from pix2pred.domains.home.settling import rise_of, settled
from pix2pred.domains.home.world import SCENERY, Body, Thing, Vector, World
from pix2pred.domains.juice.skills import FULL
from pix2pred.domains.seeds import look

Rng = np.random.Generator

JUICER = "juicer"
ASIDE = "aside"

REGION_OF: Mapping[str, Region] = {"juice": Region.JUICE, "waste": Region.WASTE}

_FRONT = (0.68, 0.76)
_ASIDE = ((0.70, 0.86), (0.38, 0.54))
_GAP = 0.16


@dataclass(frozen=True, slots=True)
class Cup:
    """A vessel: its kind, whether it stands under the ``juice`` or ``waste`` valve or ``aside``, and what it holds."""

    kind: str
    place: str = ASIDE
    contents: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class Plan:
    """What a scene holds. ``inside`` and ``squeezed`` list fruits; the others lie on the counter."""

    cups: Mapping[str, Cup]
    fruits: Sequence[str] = ()
    inside: Sequence[str] = ()
    squeezed: Sequence[str] = ()
    opened: bool = True
    powered: bool = True
    gaze: str = ""


def make_world(plan: Plan, body: Body, style: str, rng: Rng) -> World:
    """The world of ``plan`` at rest, everything else drawn from ``rng``."""
    counter = Thing("counter", SCENERY, "counter", look(rng), (0.97, 0.0, 0.0))
    top = table_size(counter).height
    place = (float(rng.uniform(1.05, 1.10)), float(rng.uniform(-0.05, 0.05)), top)
    juicer = Thing(JUICER, "juicer", "juicer", look(rng), place, opened=plan.opened, powered=plan.powered)
    taken: list[Place] = []
    cups = [_cup(name, cup, juicer, taken, rng) for name, cup in plan.cups.items()]
    fruits = [_fruit(name, plan, juicer, taken, rng) for name in plan.fruits]
    return settled(World((counter, juicer, *cups, *fruits), body, look(rng), style, plan.gaze), 0.8)


def _cup(name: str, cup: Cup, juicer: Thing, taken: list[Place], rng: Rng) -> Thing:
    made = cup_at(name, cup.kind, cup.contents, (0.0, 0.0, juicer.at[2]), rng)
    if cup.place in REGION_OF:
        x, y, z = region_middle(juicer, REGION_OF[cup.place])
        return replace(made, at=(x + float(rng.uniform(-0.015, 0.015)), y + float(rng.uniform(-0.015, 0.015)), z))
    x, y = aside(taken, rng)
    return replace(made, at=(x, y, juicer.at[2]))


def cup_at(name: str, kind: str, contents: Sequence[str], at: Vector, rng: Rng) -> Thing:
    """A vessel that stands at ``at``, full of ``contents`` if there are any."""
    return Thing(name, "container", kind, look(rng), at, contents=tuple(contents), amount=FULL * bool(contents))


def aside(taken: list[Place], rng: Rng) -> Place:
    """A free place for a vessel at the left or right of the counter: the best of many."""
    (x0, x1), (y0, y1) = _ASIDE
    tries = rng.uniform((x0, y0), (x1, y1), size=(30, 2)) * rng.choice([(1, -1), (1, 1)], size=30)
    return apart(tries, taken, _GAP)


def front(taken: list[Place], rng: Rng) -> Place:
    """A free place for a fruit at the front edge of the counter."""
    tries = np.stack(
        [rng.uniform(*_FRONT, size=30), rng.uniform(0.12, 0.36, size=30) * rng.choice((-1, 1), size=30)], 1
    )
    return apart(tries, taken, _GAP)


def _fruit(name: str, plan: Plan, juicer: Thing, taken: list[Place], rng: Rng) -> Thing:
    if name in plan.inside:
        return fruit_in(juicer, name, list(plan.inside).index(name), rng)
    if name in plan.squeezed:
        return squeezed_at(juicer, name, list(plan.squeezed).index(name), rng)
    made = Thing(name, "movable_object", name, look(rng))
    x, y = front(taken, rng)
    return replace(made, at=(x, y, juicer.at[2] + rise_of(made) + 0.003))


def fruit_in(juicer: Thing, kind: str, number: int, rng: Rng) -> Thing:
    """A fruit in a juicer's hopper, beside the ``number`` others that are in it already."""
    made = Thing(kind, "movable_object", kind, look(rng))
    dx, dy = ((-0.035, 0.0), (0.03, 0.03), (0.03, -0.03))[number]
    x, y, z = juicer.at
    return replace(made, at=(x + dx, y + dy, z + HOPPER_BOTTOM + 0.01 + rise_of(made)))


def squeezed_at(juicer: Thing, kind: str, number: int, rng: Rng) -> Thing:
    """What is left of a fruit on the tray before a juicer, in front of the ``number`` others there."""
    x, y, z = juicer.at
    at = (x + RIND_PLACE[0] - 0.075 * number, y, z + 0.009)
    return Thing(kind, "movable_object", kind, look(rng), at, squeezed=True)
