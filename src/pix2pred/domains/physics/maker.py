"""Puts simple shapes, surfaces and lights into a MuJoCo scene. Geoms are called ``object/part``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pix2pred.domains.physics.library import mujoco_library

_FRICTION = (0.9, 0.02, 0.004)
_DENSITY = 250.0
"""Kilograms per cubic metre: plastic and wood with air in it."""


class Maker:
    """Collects a scene; ``compiled`` gives the model, whose pictures have up to ``width`` by ``height`` pixels."""

    def __init__(self, width: int, height: int) -> None:
        mujoco = self._mujoco = mujoco_library()
        self._kinds = mujoco.mjtGeom
        spec = self.spec = mujoco.MjSpec()
        spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
        spec.visual.quality.offsamples = 4
        spec.visual.headlight.specular = [0.05, 0.05, 0.05]
        spec.visual.map.znear, spec.visual.map.zfar = 0.01, 12.0
        spec.option.timestep = 0.004
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        self.world = spec.worldbody

    def compiled(self) -> Any:
        """The model."""
        return self.spec.compile()

    def body(self, name: str, *, free: bool = False) -> Any:
        """A body placed at run time: ``free`` obeys physics, others stand where they are put."""
        body = self.world.add_body(name=name, mocap=not free)
        if free:
            body.add_freejoint(name=name)
        return body

    def texture(self, name: str, pixels: NDArray[np.uint8], size: float) -> None:
        """A material whose pattern repeats every ``size`` metres."""
        mujoco = self._mujoco
        kind = mujoco.mjtTexture.mjTEXTURE_2D
        texture = self.spec.add_texture(name=name, type=kind, width=pixels.shape[1], height=pixels.shape[0], nchannel=3)
        texture.data = pixels.tobytes()
        material = self.spec.add_material(name=name, texuniform=True, texrepeat=[1 / size, 1 / size])
        material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
        material.specular = 0.1

    def slab(
        self, name: str, half: Sequence[float], at: Sequence[float], colour: Sequence[float] = (1, 1, 1), **more: Any
    ) -> None:
        """A box with the half sizes ``half``."""
        self._geom(name, self._kinds.mjGEOM_BOX, half, at, colour, **more)

    def drum(
        self,
        name: str,
        radius: float,
        half: float,
        at: Sequence[float],
        colour: Sequence[float] = (1, 1, 1),
        **more: Any,
    ) -> None:
        """An upright cylinder."""
        self._geom(name, self._kinds.mjGEOM_CYLINDER, (radius, half, 0), at, colour, **more)

    def egg(self, name: str, half: Sequence[float], at: Sequence[float], colour: Sequence[float], **more: Any) -> None:
        """An ellipsoid."""
        self._geom(name, self._kinds.mjGEOM_ELLIPSOID, half, at, colour, **more)

    def ball(self, name: str, radius: float, at: Sequence[float], colour: Sequence[float], **more: Any) -> None:
        """A sphere."""
        self._geom(name, self._kinds.mjGEOM_SPHERE, (radius, 0, 0), at, colour, **more)

    def rod(
        self, name: str, radius: float, a: Sequence[float], b: Sequence[float], colour: Sequence[float], **more: Any
    ) -> None:
        """A capsule from ``a`` to ``b``."""
        self._geom(name, self._kinds.mjGEOM_CAPSULE, (radius, 0, 0), None, colour, fromto=[*a, *b], **more)

    def shape(
        self, name: str, mesh: str, colour: Sequence[float], at: Sequence[float] = (0, 0, 0), **more: Any
    ) -> None:
        """A mesh that was added before."""
        self._geom(name, self._kinds.mjGEOM_MESH, (0, 0, 0), at, colour, meshname=mesh, **more)

    def turned(self, name: str, profile: Sequence[tuple[float, float]], sides: int = 28) -> None:
        """A mesh: ``profile`` (radius, height) turned about the vertical axis."""
        angles = np.linspace(0, 2 * np.pi, sides, endpoint=False)
        points = [(r * np.cos(a), r * np.sin(a), z) for r, z in profile for a in angles]
        faces: list[tuple[int, int, int]] = []
        for ring in range(len(profile) - 1):
            for k in range(sides):
                a, b = ring * sides + k, ring * sides + (k + 1) % sides
                c, d = a + sides, b + sides
                if profile[ring][0] > 0:
                    faces.append((a, b, d))
                if profile[ring + 1][0] > 0:
                    faces.append((a, d, c))
        self.spec.add_mesh(
            name=name,
            uservert=[float(v) for p in points for v in p],
            userface=[int(i) for f in faces for i in f],
            inertia=self._mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        )

    def light(self, at: Sequence[float], colour: Sequence[float], cone: float, fading: float) -> None:
        """A lamp that shines down: half the angle of its cone in degrees, and how it fades towards the edge."""
        self.world.add_light(
            pos=list(at),
            dir=[-0.25 * at[0], -0.25 * at[1], -1],
            diffuse=list(colour),
            specular=[0.1] * 3,
            castshadow=False,
            cutoff=cone,
            exponent=fading,
        )

    def ambient(self, strength: float, ahead: float) -> None:
        """Light from everywhere, and some from where one looks from."""
        headlight = self.spec.visual.headlight
        headlight.ambient, headlight.diffuse = [strength] * 3, [ahead] * 3

    def camera(self, body: Any, name: str, at: Sequence[float], turn: Sequence[float], fovy: float) -> None:
        """A camera fixed to a body; ``turn`` is its quaternion."""
        body.add_camera(name=name, pos=list(at), quat=list(turn), fovy=fovy)

    def _geom(
        self,
        name: str,
        kind: Any,
        size: Sequence[float],
        at: Sequence[float] | None,
        colour: Sequence[float],
        *,
        body: Any = None,
        solid: bool = False,
        glow: float = 0.0,
        material: str | None = None,
        alpha: float = 1.0,
        **more: Any,
    ) -> None:
        """Solid geoms collide; those of free bodies have weight, and only solid ones do."""
        if glow:
            material = f"glow{glow:g}"
            if not any(m.name == material for m in self.spec.materials):
                self.spec.add_material(name=material, emission=glow)
        if material:
            more["material"] = material
        if at is not None:
            more["pos"] = list(at)
        (body or self.world).add_geom(
            name=name,
            type=kind,
            size=list(size),
            rgba=[*colour, alpha],
            contype=int(solid),
            conaffinity=int(solid),
            density=_DENSITY if solid else 0.0,
            condim=6 if solid else 3,  # rolling and spinning come to rest
            **{"friction": list(_FRICTION)} | more,
        )
