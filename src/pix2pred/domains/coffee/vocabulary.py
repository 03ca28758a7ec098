"""Types, skills and given predicates of the coffee domain (method 10.3).

Hidden from the learner, and therefore no feature: how full jug and cups are, whether the machine is on, and over which
spot of the table jug and gripper are: where the jug was last brought tells what was filled last.
"""

from __future__ import annotations

from collections.abc import Mapping

from pix2pred.structs import FromDomain, Object, Predicate, Skill, Type

ROBOT = Type(
    "robot",
    ("z", "tilt", "wrist", "fingers"),
    measures=(
        "z is the height between the finger tips; tilt turns the gripper from pointing right (0) to pointing down, "
        "wrist about its own axis (radians); fingers is how far it is open. Lengths are in metres."
    ),
)
JUG = Type(
    "jug",
    ("z", "rot", "is_held"),
    measures=(
        "z is the height of its base in metres; rot is how far it is turned, in radians, 0 with its handle on the "
        "left; is_held is 1 while it is held, else 0."
    ),
)
MACHINE = Type("coffee_machine")
CUP = Type(
    "cup",
    ("x", "y", "z", "capacity"),
    measures="x to the right, y to the back, z up, in metres; capacity in cups of middle size.",
)

TYPES = (ROBOT, JUG, MACHINE, CUP)
TYPE_OF: Mapping[str, Type] = {t.name: t for t in TYPES}

PICK_JUG = Skill(
    "PickJug",
    (ROBOT, JUG),
    description="The robot grips the upright jug by its handle, which has to be in reach, and lifts it.",
)
PLACE_JUG = Skill(
    "PlaceJugInMachine",
    (ROBOT, JUG, MACHINE),
    description="The robot puts the jug it holds upright into the coffee machine and lets go of it.",
)
TURN_ON = Skill(
    "TurnMachineOnAndFill",
    (ROBOT, MACHINE),
    description="The robot presses the button of the coffee machine, which fills the jug that stands in it.",
)
POUR = Skill(
    "PourSomeLiquid",
    (ROBOT, JUG, CUP),
    description="The robot holds the jug over a cup and tilts it until the cup is full.",
)
ROTATE = Skill(
    "RotateItemUntilHandleAccessible",
    (ROBOT, JUG),
    description="The robot turns the jug on the table until its handle is on the left, where it is in reach.",
)
SKILLS = (PICK_JUG, PLACE_JUG, TURN_ON, POUR, ROTATE)
SKILL_OF: Mapping[str, Skill] = {s.name: s for s in SKILLS}

CUP_FILLED = Predicate("CupFilled", (CUP,), FromDomain(), "The cup is more than three quarters full of coffee.")
HOLDING = Predicate("Holding", (ROBOT, JUG), FromDomain(), "The robot has the jug in its gripper.")
ON_TABLE = Predicate(
    "OnTable", (JUG,), FromDomain(), "The jug stands on the table: it is neither held nor in the machine."
)
HAND_EMPTY = Predicate("HandEmpty", (ROBOT,), FromDomain(), "The robot's gripper holds nothing.")
ROBOT_ABOVE_CUP = Predicate(
    "RobotAboveCup", (ROBOT, CUP), FromDomain(), "The robot holds the jug, and with it is over the cup."
)
JUG_ABOVE_CUP = Predicate("JugAboveCup", (JUG, CUP), FromDomain(), "The jug is held over the cup.")
NOT_ABOVE_CUP = Predicate("NotAboveCup", (ROBOT, JUG), FromDomain(), "The robot does not hold the jug over any cup.")
PRESSING_BUTTON = Predicate(
    "PressingButton", (ROBOT, MACHINE), FromDomain(), "The robot's finger is on the button of the coffee machine."
)
NOT_SAME_CUP = Predicate("NotSameCup", (CUP, CUP), FromDomain(), "The two cups are different cups; this never changes.")
JUG_PICKABLE = Predicate(
    "JugPickable", (JUG,), FromDomain(), "The jug is upright with its handle on the left, where the robot can grip it."
)

GIVEN = (
    CUP_FILLED, HOLDING, ON_TABLE, HAND_EMPTY, ROBOT_ABOVE_CUP, JUG_ABOVE_CUP, NOT_ABOVE_CUP, PRESSING_BUTTON,
    NOT_SAME_CUP, JUG_PICKABLE,
)  # fmt: skip


def make_object(name: str, type_name: str) -> Object:
    """The object called ``name``; its name is its descriptor."""
    return Object(name, TYPE_OF[type_name], name)
