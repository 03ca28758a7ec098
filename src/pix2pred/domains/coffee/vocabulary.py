"""Types, skills and given predicates of the coffee domain (method 10.3).

Hidden from the learner, and therefore no feature: how full jug and cups are, whether the machine is on, and over which
spot of the table jug and gripper are: where the jug was last brought tells what was filled last.
"""

from __future__ import annotations

from collections.abc import Mapping

from pix2pred.structs import FromDomain, Object, Predicate, Skill, Type

ROBOT = Type("robot", ("z", "tilt", "wrist", "fingers"))
JUG = Type("jug", ("z", "rot", "is_held"))
MACHINE = Type("coffee_machine")
CUP = Type("cup", ("x", "y", "z", "capacity"))

TYPES = (ROBOT, JUG, MACHINE, CUP)
TYPE_OF: Mapping[str, Type] = {t.name: t for t in TYPES}

PICK_JUG = Skill("PickJug", (ROBOT, JUG))
PLACE_JUG = Skill("PlaceJugInMachine", (ROBOT, JUG, MACHINE))
TURN_ON = Skill("TurnMachineOnAndFill", (ROBOT, MACHINE))
POUR = Skill("PourSomeLiquid", (ROBOT, JUG, CUP))
ROTATE = Skill("RotateItemUntilHandleAccessible", (ROBOT, JUG))
SKILLS = (PICK_JUG, PLACE_JUG, TURN_ON, POUR, ROTATE)
SKILL_OF: Mapping[str, Skill] = {s.name: s for s in SKILLS}

CUP_FILLED = Predicate("CupFilled", (CUP,), FromDomain())
HOLDING = Predicate("Holding", (ROBOT, JUG), FromDomain())
ON_TABLE = Predicate("OnTable", (JUG,), FromDomain())
HAND_EMPTY = Predicate("HandEmpty", (ROBOT,), FromDomain())
ROBOT_ABOVE_CUP = Predicate("RobotAboveCup", (ROBOT, CUP), FromDomain())
JUG_ABOVE_CUP = Predicate("JugAboveCup", (JUG, CUP), FromDomain())
NOT_ABOVE_CUP = Predicate("NotAboveCup", (ROBOT, JUG), FromDomain())
PRESSING_BUTTON = Predicate("PressingButton", (ROBOT, MACHINE), FromDomain())
NOT_SAME_CUP = Predicate("NotSameCup", (CUP, CUP), FromDomain())
JUG_PICKABLE = Predicate("JugPickable", (JUG,), FromDomain())

GIVEN = (
    CUP_FILLED, HOLDING, ON_TABLE, HAND_EMPTY, ROBOT_ABOVE_CUP, JUG_ABOVE_CUP, NOT_ABOVE_CUP, PRESSING_BUTTON,
    NOT_SAME_CUP, JUG_PICKABLE,
)  # fmt: skip


def make_object(name: str, type_name: str) -> Object:
    """The object called ``name``; its name is its descriptor."""
    return Object(name, TYPE_OF[type_name], name)
