"""Types, skills and given predicates of the burger domain (method 10.2)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from pix2pred.structs import FromDomain, Object, Predicate, Skill, Type

_PLACE = ("row", "col", "z")
_CELLS = (
    "row and col are the cell of the floor, from 0 at the top and at the left; z is the level in a stack, 0 on the "
    "floor. What is held is in the robot's cell, at level 1."
)

OBJECT = Type("object", _PLACE, None, "Everything that has a name.", _CELLS)
ITEM = Type("item", _PLACE, OBJECT, "What can be picked up and stacked: the parts of a burger.")
STATION = Type("station", _PLACE, OBJECT, "What stays where it stands and has something done to the item on it.")
ROBOT = Type(
    "robot",
    (*_PLACE, "fingers", "dir"),
    OBJECT,
    measures="fingers is 1 while it holds something, else 0; dir is where it faces: 0 up, 1 left, 2 down, 3 right.",
)
PATTY = Type("patty", _PLACE, ITEM)
LETTUCE = Type("lettuce", _PLACE, ITEM)
CHEESE = Type("cheese", _PLACE, ITEM)
BOTTOM_BUN = Type("bottom_bun", _PLACE, ITEM)
TOP_BUN = Type("top_bun", _PLACE, ITEM)
GRILL = Type("grill", _PLACE, STATION)
CUTTING_BOARD = Type("cutting_board", _PLACE, STATION)

TYPES = (
    OBJECT, ITEM, STATION, ROBOT, PATTY, LETTUCE, CHEESE, BOTTOM_BUN, TOP_BUN, GRILL, CUTTING_BOARD,
)  # fmt: skip
TYPE_OF: Mapping[str, Type] = {t.name: t for t in TYPES}

PICK = Skill(
    "Pick", (ROBOT, ITEM), description="The robot goes to an item on which nothing lies and takes it in its empty hand."
)
PLACE = Skill(
    "Place",
    (ROBOT, ITEM, OBJECT),
    description="The robot puts the item it holds on top of an object on which nothing lies.",
)
COOK = Skill(
    "Cook", (ROBOT, PATTY, GRILL), description="The robot, its hand empty, cooks a patty that lies on the grill."
)
CHOP = Skill(
    "Chop",
    (ROBOT, LETTUCE, CUTTING_BOARD),
    description="The robot, its hand empty, chops a lettuce that lies on the cutting board.",
)
SKILLS = (PICK, PLACE, COOK, CHOP)
SKILL_OF: Mapping[str, Skill] = {s.name: s for s in SKILLS}

ON = Predicate("On", (ITEM, OBJECT), FromDomain(), "The item lies directly on the object, with nothing between them.")
ON_GROUND = Predicate(
    "OnGround", (ITEM,), FromDomain(), "The item lies on the floor: it is neither held nor on a thing."
)
CLEAR = Predicate("Clear", (OBJECT,), FromDomain(), "Nothing lies on the object, and it is not held.")
HOLDING = Predicate("Holding", (ROBOT, ITEM), FromDomain(), "The robot has the item in its hand.")
SHARED = (ON, ON_GROUND, CLEAR, HOLDING)

COMPOSITE_DESCRIPTIONS: Mapping[str, str] = {
    "SomewhereAboveAndPrepped": (
        "The second object is ready to be eaten (a patty cooked, a lettuce chopped) and lies in the stack that stands "
        "on the first, however many things are between them."
    ),
    "RightAboveAndPrepped": (
        "The second object is ready to be eaten (a patty cooked, a lettuce chopped) and lies directly on the first."
    ),
}
"""What the goal predicates mean; the first object is the lower one."""

Signatures = Mapping[str, Iterable[tuple[str, ...]]]
"""Printed predicate name to the tuples of argument type names it is declared with."""


def printed_name(predicate: str) -> str:
    """The name without the number that tells signatures apart: ``RightAboveAndPrepped1`` is printed without 1."""
    return predicate.rstrip("0123456789")


def composites(signatures: Signatures) -> tuple[Predicate, ...]:
    """Goal predicates with one unique name per signature.

    A printed name with one signature keeps it; several are numbered 0, 1, 2... in the order of their sorted tuples
    of type names.
    """
    built = []
    for name in sorted(signatures):
        ordered = sorted(signatures[name])
        for index, types in enumerate(ordered):
            unique = name if len(ordered) == 1 else f"{name}{index}"
            built.append(
                Predicate(unique, tuple(TYPE_OF[t] for t in types), FromDomain(), COMPOSITE_DESCRIPTIONS[name])
            )
    return tuple(built)


def find_predicate(predicates: Iterable[Predicate], name: str, args: tuple[Object, ...]) -> Predicate:
    """The predicate printed as ``name`` whose argument types fit ``args``. Raises ``ValueError`` when there is none."""
    for predicate in predicates:
        if (
            name in (predicate.name, printed_name(predicate.name))
            and len(args) == predicate.arity
            and all(o.type.is_a(t) for o, t in zip(args, predicate.types, strict=True))
        ):
            return predicate
    raise ValueError(f"no predicate {name} over ({', '.join(o.type.name for o in args)})")


def make_object(name: str, type_name: str) -> Object:
    """The object called ``name``; its name is its descriptor."""
    return Object(name, TYPE_OF[type_name], name)
