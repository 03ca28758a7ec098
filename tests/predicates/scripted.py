"""What the tests of this room share: a small scene, its demonstration, and a model that says what it is told."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from pix2pred.structs import (
    Action,
    Box,
    Candidate,
    Demo,
    FromDomain,
    FromVLM,
    Image,
    Object,
    Picture,
    Predicate,
    Skill,
    State,
    Type,
)
from pix2pred.vlm import Answer, Request

ITEM = Type("item")
PATTY = Type("patty", (), ITEM)
CUP = Type("cup", (), ITEM)
ROBOT = Type("robot")
TYPES = (ITEM, PATTY, CUP, ROBOT)
R, P1, P2 = Object("robot", ROBOT, "robot"), Object("p1", PATTY, "patty1"), Object("p2", PATTY, "patty2")
BLUE_CUP = Object("c", CUP, "small blue-cup")
OBJECTS = (R, P1, P2, BLUE_CUP)
PICK = Skill("Pick", (ROBOT, ITEM))
HOLDING = Predicate("Holding", (ROBOT, ITEM), FromDomain())
COOKED = Predicate("cooked0", (PATTY,), FromVLM("cooked"))
UNDER = Predicate("under1", (PATTY, CUP), FromVLM("under"))
POOL = (Candidate(COOKED, 1.0), Candidate(UNDER, 2.0))


def picture(seed: int, camera: str = "main", boxes: bool = True) -> Picture:
    """A 40x40 picture of noise; each object's box is 8 pixels wide, beside the one before."""
    pixels = np.random.default_rng(seed).integers(0, 256, (40, 40, 3), dtype=np.uint8)
    places = {o.name: Box(10.0 * i, 10.0, 10.0 * i + 8, 18.0) for i, o in enumerate(OBJECTS)}
    return Picture(camera, Image.from_pixels(pixels), places if boxes else {})


def state(seed: int, *, cameras: Sequence[str] = ("main",), boxes: bool = True) -> State:
    return State(tuple(picture(10 * seed + i, camera, boxes) for i, camera in enumerate(cameras)))


def demo(*, actions: int = 2, cameras: Sequence[str] = ("main",), boxes: bool = True, name: str = "d") -> Demo:
    """Picks of the first patty, with different pictures everywhere."""
    states = tuple(state(t, cameras=cameras, boxes=boxes) for t in range(actions + 1))
    return Demo(name, OBJECTS, states, (Action(PICK, (R, P1)),) * actions, (HOLDING(R, P1),))


Script = Sequence[str] | Callable[[Request], str]


@dataclass(slots=True)
class ScriptedVLM:
    """Gives the answers of a script, in order or computed from the request, and remembers what it was asked."""

    script: Script
    name: str = "scripted"
    asked: list[Request] = field(default_factory=list)
    lock: threading.Lock = field(default_factory=threading.Lock)

    def answer(self, request: Request) -> Answer:
        with self.lock:
            self.asked.append(request)
            if callable(self.script):
                return Answer(self.script(request))
            return Answer(self.script[len(self.asked) - 1])
