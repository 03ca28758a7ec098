"""A scene as a MuJoCo model: posed as a world says, settled by physics, and looked at."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np

from pix2pred.domains.home.drawing import bodies, fixtures, vessels
from pix2pred.domains.home.drawing.movables import FRUIT_COLOUR, KINDS
from pix2pred.domains.home.drawing.room import EVEN, SPOTS, furnish
from pix2pred.domains.home.world import UPRIGHT, Body, Quaternion, Thing, Vector, World, vector
from pix2pred.domains.physics import Maker, mujoco_library

AWAY: Vector = (0.0, 0.0, -8.0)
"""Where a held thing is that no camera sees."""

_SHADOW = 0.0012


def is_free(thing: Thing) -> bool:
    """Whether physics moves the thing: vessels are put down upright, fixtures stand."""
    return thing.kind in KINDS


class PhysicalScene:
    """The model of one scene, in which a robot is made by ``robot``. Use it in one thread only."""

    def __init__(self, world: World, robot: Callable[[Maker], None] = bodies.make_robot) -> None:
        self._mujoco = mujoco_library()
        maker = Maker(bodies.WIDTH, bodies.HEIGHT)
        furnish(maker, world.room, world.style, EVEN if world.of_type("juicer") else SPOTS)
        (bodies.make_person if world.body is Body.HUMAN else robot)(maker)
        for thing in world.things:
            _make(maker, thing)
        self.model = maker.compiled()
        self.data = self._mujoco.MjData(self.model)
        self._geoms = {self.model.geom(i).name: i for i in range(self.model.ngeom)}
        self._alpha = self.model.geom_rgba[:, 3].copy()

    def pose(self, world: World) -> None:
        """Put everything where ``world`` says."""
        for thing in world.things:
            held = thing.name == world.holding
            at, turn = (AWAY, UPRIGHT) if held else (thing.at, thing.turn)
            self._place(thing, at, turn)
            self._details(thing)
            self._shadow(world, thing, hidden=held or thing.squeezed)
        if world.body is Body.HUMAN:
            self._person(world)
        self._mujoco.mj_forward(self.model, self.data)

    def objects(self, world: World) -> Mapping[str, Sequence[int]]:
        """The geoms of every object of ``world``."""
        found: dict[str, list[int]] = {name: [] for name in world.types()}
        for geom, number in self._geoms.items():
            owner = geom.partition("/")[0].removesuffix("-rind")
            if owner in found and not geom.endswith("/glass"):
                found[owner].append(number)
        return found

    def settle(self, world: World, seconds: float = 1.2) -> World:
        """The world after physics moved what is free for a while, the hand away."""
        self.pose(world)
        if world.holding is not None and is_free(world.thing(world.holding)):
            self._place(world.thing(world.holding), AWAY, UPRIGHT)
        self.data.qvel[:] = 0
        for _ in range(round(seconds / self.model.opt.timestep)):
            self.advance()
        return self.moved(world)

    def advance(self) -> None:
        """One step of physics."""
        self._mujoco.mj_step(self.model, self.data)

    def moved(self, world: World) -> World:
        """The world with every free thing where physics has it now."""
        changed = []
        for thing in world.things:
            if is_free(thing) and thing.name != world.holding:
                q = self.data.joint(thing.name).qpos
                x, y, z, a, b, c, d = (round(float(v), 5) for v in q)
                changed.append(replace(thing, at=(x, y, z), turn=(a, b, c, d)))
        return world.with_thing(*changed)

    def move_fixture(self, name: str, at: Vector, turn: Quaternion) -> None:
        """Move a fixture while physics runs."""
        mocap = int(self.model.body(name).mocapid[0])
        self.data.mocap_pos[mocap], self.data.mocap_quat[mocap] = at, turn

    @contextmanager
    def without_glass(self) -> Iterator[None]:
        """Leave out the clear walls of hoppers meanwhile."""
        walls = [number for geom, number in self._geoms.items() if geom.endswith("/glass")]
        self.model.geom_rgba[walls, 3] = 0.0
        try:
            yield
        finally:
            self.model.geom_rgba[walls, 3] = self._alpha[walls]

    def _place(self, thing: Thing, at: Vector, turn: Quaternion) -> None:
        if is_free(thing):
            joint = self.data.joint(thing.name)
            joint.qpos[:] = (*at, *turn)
            joint.qvel[:] = 0
        else:
            self.move_fixture(thing.name, at, turn)

    def _details(self, thing: Thing) -> None:
        name, rgba = thing.name, self.model.geom_rgba
        if thing.kind == "table":
            for geom, number in self._geoms.items():
                if geom.startswith(f"{name}/stroke"):
                    stroke = int(geom.removeprefix(f"{name}/stroke").partition("-")[0])
                    rgba[number, 3] = 1.0 if stroke in thing.strokes else 0.0
        elif thing.kind in vessels.VESSELS:
            self._liquid(thing)
        elif thing.kind == "juicer":
            self._juicer(thing)
        elif thing.type == "movable_object" and f"{name}-rind/peel" in self._geoms:
            for geom, number in self._geoms.items():
                if geom.startswith(f"{name}/"):
                    rgba[number, 3] = 0.0 if thing.squeezed else self._alpha[number]
            self._rind(thing)

    def _liquid(self, thing: Thing) -> None:
        model, bottom = self.model, vessels.BOTTOM
        shape = vessels.level(thing.kind, thing.amount)
        colours = vessels.liquid_colours(thing.contents) if thing.amount > 0 else []
        liquid = self._geoms[f"{thing.name}/liquid"]
        mixed = np.mean(colours, axis=0) if colours else np.zeros(3)
        model.geom_rgba[liquid] = (*0.92 * mixed, float(bool(colours)))
        model.geom_size[liquid][:2] = (shape.radius, shape.height / 2)
        model.geom_pos[liquid] = (0, 0, bottom + shape.height / 2)
        for k in range(vessels.MOST_LIQUIDS):
            ring = self._geoms[f"{thing.name}/surface{k}"]
            share = math.sqrt(1 - k / len(colours)) if k < len(colours) else 0.1
            model.geom_rgba[ring] = (*colours[k], 1.0) if k < len(colours) else (0, 0, 0, 0)
            model.geom_size[ring][:2] = (share * shape.surface, 0.0012)
            model.geom_pos[ring] = (0, 0, bottom + shape.height + 0.0008 * k)

    def _juicer(self, thing: Thing) -> None:
        lamp = self._geoms[f"{thing.name}/lamp"]
        self.model.geom_rgba[lamp] = (0.25, 1.0, 0.40, 1) if thing.powered else (0.05, 0.05, 0.05, 1)
        self.model.geom_matid[lamp] = self._lit if thing.powered else -1
        x, y, z = thing.at
        hinge = (x + vessels.HOPPER_RADIUS, y, z + vessels.HOPPER_TOP + 0.012)
        half = math.radians(105 if thing.opened else 0) / 2
        self.move_fixture(f"{thing.name}-lid", hinge, (math.cos(half), 0, math.sin(half), 0))

    @property
    def _lit(self) -> int:
        return int(self.model.material("glow0.9").id)

    def _rind(self, thing: Thing) -> None:
        at = thing.at if thing.squeezed else AWAY
        self.move_fixture(f"{thing.name}-rind", at, UPRIGHT)

    def _shadow(self, world: World, thing: Thing, *, hidden: bool) -> None:
        if f"shadow-{thing.name}" not in self._geoms:
            return
        x, y, z = thing.at
        under = support_height(world, x, y, z)
        self.move_fixture(f"shadow-{thing.name}", AWAY if hidden or under is None else (x, y, under + _SHADOW), UPRIGHT)

    def _person(self, world: World) -> None:
        target = gaze_point(world)
        eye = bodies.eyes(target)
        yaw, pitch = bodies.gaze_angles(target, eye)
        self.move_fixture("head", eye, bodies.quaternion(bodies.camera_axes(yaw, pitch, 0)))
        held = world.thing(world.holding) if world.holding else None
        where, axes = bodies.hand_frame(eye, yaw, pitch, (0.17, 0.18, 0.52) if held else (0.28, 0.31, 0.52))
        self.move_fixture("hand", vector(where), bodies.quaternion(axes))
        if held:
            reach = 0.115 if held.kind in vessels.VESSELS else 0.075
            below = where + axes @ np.array([reach, 0.0, -0.045])
            if held.kind in vessels.VESSELS:
                below = below - np.array([0, 0, vessels.VESSELS[held.kind].height * 0.75])
            elif held.squeezed:
                self.move_fixture(f"{held.name}-rind", vector(below), UPRIGHT)
            turn = math.radians(yaw + 20) / 2
            upright = (math.cos(turn), 0.0, 0.0, math.sin(turn))
            self._place(held, vector(below), upright)


def gaze_point(world: World) -> Vector:
    """What a person looks at: between the thing in question and the middle of the scene."""
    if not world.gaze or world.gaze not in world.types() or world.gaze == world.actor:
        return (0.85, 0.0, 0.3)
    thing = world.thing(world.gaze)
    x, y, z = (0.85, 0.0, 0.3) if thing.name == world.holding else thing.at
    if thing.kind in fixtures.TOPS:
        z = fixtures.table_size(thing).height
    higher = 0.30 if world.of_type("juicer") else 0.0  # an open lid stands high
    return (0.4 * x + 0.6 * 0.80, 0.34 * y, 0.45 * z + 0.14 + higher)


def support_height(world: World, x: float, y: float, z: float) -> float | None:
    """Height of the table top or floor under a thing; None inside a bin, where no shadow is drawn."""
    for thing in world.things:
        if thing.kind in ("narrow_bin", "wide_bin"):
            if fixtures.bin_size(thing).is_under((x, y), thing.at, 0.02):
                return None
        elif thing.kind in fixtures.TOPS:
            top = fixtures.table_size(thing)
            if top.is_under((x, y), thing.at) and z > top.height - 0.02:
                return top.height
    return 0.0


def _make(maker: Maker, thing: Thing) -> None:
    if is_free(thing):
        kind = KINDS[thing.kind]
        body = maker.body(thing.name, free=True)
        kind.make(maker, body, thing.name, np.random.default_rng(thing.look))
        _make_shadow(maker, thing, kind.radius * kind.shade)
        if thing.kind in FRUIT_COLOUR:
            _make_rind(maker, thing)
        return
    body = maker.body(thing.name)
    if thing.kind in fixtures.TOPS:
        fixtures.make_table(maker, body, thing)
        if thing.kind == "table":
            fixtures.make_strokes(maker, body, thing)
        size = fixtures.table_size(thing)
        maker.slab(
            f"shade/{thing.name}", (size.half_x, size.half_y, 0.0006), (0, 0, 0.0006), (0, 0, 0), body=body, alpha=0.25
        )
    elif thing.kind in ("narrow_bin", "wide_bin"):
        fixtures.make_bin(maker, body, thing)
        inside = fixtures.bin_size(thing)
        half = (inside.half_x + 0.04, inside.half_y + 0.04, 0.0006)
        maker.slab(f"shade/{thing.name}", half, (0, 0, 0.0006), (0, 0, 0), body=body, alpha=0.3)
    elif thing.kind == "juicer":
        vessels.make_juicer(maker, body, thing)
        vessels.make_regions(maker, body, thing)
    else:
        vessels.make_vessel(maker, body, thing)
        _make_shadow(maker, thing, vessels.VESSELS[thing.kind].foot * 1.2)


def _make_shadow(maker: Maker, thing: Thing, radius: float) -> None:
    maker.drum(
        f"shadow-{thing.name}",
        radius,
        0.0003,
        (0, 0, 0),
        (0, 0, 0),
        body=maker.body(f"shadow-{thing.name}"),
        alpha=0.22,
    )


def _make_rind(maker: Maker, thing: Thing) -> None:
    """Two hollow halves of squeezed fruit; what is left of their flesh has the colour of the juice."""
    body = maker.body(f"{thing.name}-rind")
    colour = FRUIT_COLOUR[thing.kind]
    for k, y in enumerate((-0.036, 0.036)):
        name = "peel" if k == 0 else "peel1"
        maker.turned(
            f"{thing.name}-{name}", [(0, 0), (0.022, 0.004), (0.033, 0.022), (0.029, 0.022), (0.019, 0.008), (0, 0.006)]
        )
        shell = tuple(0.9 * c for c in colour)
        maker.shape(f"{thing.name}-rind/{name}", f"{thing.name}-{name}", shell, (0, y, 0), body=body)
        maker.drum(f"{thing.name}-rind/pith{k}", 0.026, 0.001, (0, y, 0.017), (0.95, 0.90, 0.74), body=body)
        maker.drum(f"{thing.name}-rind/flesh{k}", 0.021, 0.001, (0, y, 0.0185), colour, body=body)


_KEPT = 3
_STAGES: OrderedDict[tuple[Any, ...], PhysicalScene] = OrderedDict()


def scene_key(world: World) -> tuple[Any, ...]:
    """What two worlds share that can be drawn with one model."""
    lids = (t.opened if t.type == "trash_can" else True for t in world.things)
    return world.room, world.style, world.body, tuple((t.name, t.kind, t.look) for t in world.things), tuple(lids)


def stage_for(world: World) -> PhysicalScene:
    """The stage of the scene, kept for the next few questions about it."""
    key = scene_key(world)
    if key not in _STAGES:
        _STAGES[key] = PhysicalScene(world)
        if len(_STAGES) > _KEPT:
            _STAGES.popitem(last=False)
    _STAGES.move_to_end(key)
    return _STAGES[key]
