"""Types, objects, skills and given predicates of the kitchen (method 10.1)."""

from __future__ import annotations

import math
from collections.abc import Mapping

from pix2pred.structs import FromDomain, Object, Predicate, Skill, Type, Vocabulary

_PLACE = ("x", "y", "z")

OBJECT = Type("object", _PLACE, None, "Everything that has a name.", "x to the right, y to the back, z up, in metres.")
GRIPPER = Type(
    "gripper", (*_PLACE, "qw", "qx", "qy", "qz"), OBJECT, measures="qw, qx, qy, qz are its orientation, a quaternion."
)
ON_OFF = Type(
    "on_off",
    (*_PLACE, "angle"),
    OBJECT,
    "What is turned or opened, and so is on or off, open or closed.",
    "angle is how far it is turned or opened, in radians; metres for slide. Knobs: 0 is off, on is below 0.",
)
HINGE_DOOR = Type("hinge_door", (*_PLACE, "angle"), ON_OFF, "A door of a cupboard or a microwave, by its handle.")
KNOB = Type("knob", (*_PLACE, "angle"), ON_OFF, "A knob of the stove; it belongs to the burner with the same number.")
SWITCH = Type("switch", (*_PLACE, "angle"), ON_OFF, "The switch of the lamp above the stove.")
SURFACE = Type("surface", _PLACE, OBJECT, "A burner of the stove, on which a kettle can stand.")
KETTLE = Type("kettle", _PLACE, OBJECT)

TYPES = (OBJECT, GRIPPER, ON_OFF, HINGE_DOOR, KNOB, SWITCH, SURFACE, KETTLE)

_KINDS: Mapping[str, Type] = {
    "gripper": GRIPPER,
    "kettle": KETTLE,
    **{f"knob{i}": KNOB for i in range(1, 5)},
    **{f"burner{i}": SURFACE for i in range(1, 5)},
    "light": SWITCH,
    "slide": HINGE_DOOR,
    "hinge1": HINGE_DOOR,
    "hinge2": HINGE_DOOR,
    "microhandle": HINGE_DOOR,
}

OBJECTS: tuple[Object, ...] = tuple(sorted(Object(name, kind, name) for name, kind in _KINDS.items()))
"""Every object of every scene. Burners and knobs: 1 front right, 2 front left, 3 back right, 4 back left."""

OBJECT_OF: Mapping[str, Object] = {o.name: o for o in OBJECTS}

REACH = 0.3
"""Metres: bound of the offsets a push may start from."""

TURN_ON_KNOB = Skill(
    "MoveAndTurnOnKnob",
    (GRIPPER, KNOB),
    (-math.pi,),
    (math.pi,),
    "The gripper moves to a knob of the stove and turns it on with a push, whose direction is the number: radians, "
    "from the right (0) towards the back.",
)
"""Its parameter is the direction of the push in the x-y plane, in radians from x (to the right) towards y."""

PUSH_KETTLE = Skill(
    "PushKettleOntoBurner",
    (GRIPPER, KETTLE, SURFACE),
    (-REACH, -REACH, -REACH, -math.pi),
    (REACH, REACH, REACH, math.pi),
    "The gripper pushes the kettle along until it stands on the burner behind it. Its numbers are where the push "
    "starts, from the kettle's handle to the right, back and up (metres), and its direction, from back (0) towards "
    "the right (radians).",
)
"""Its parameters: where the push starts, relative to the kettle's handle (metres), and its direction, from y."""

SKILLS = (TURN_ON_KNOB, PUSH_KETTLE)

KETTLE_BOILING = Predicate(
    "KettleBoiling",
    (KETTLE, SURFACE, KNOB),
    FromDomain(),
    "The kettle stands on the burner, the knob belongs to that burner, and it is turned on.",
)
LINKED = Predicate(
    "KnobAndBurnerLinked",
    (KNOB, SURFACE),
    FromDomain(),
    "The knob is the one that turns the burner on; this never changes.",
)
INITIAL = (KETTLE_BOILING, LINKED)

VOCABULARY = Vocabulary("kitchen", TYPES, SKILLS, INITIAL)
