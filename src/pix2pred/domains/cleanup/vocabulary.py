"""Types, skills and given predicates of the cleanup domain (method 10.4). There are no object features."""

from __future__ import annotations

from pix2pred.structs import FromDomain, FromVLM, Predicate, Skill, Type

ROBOT = Type("robot")
MOVABLE = Type("movable_object", description="A thing that can be picked up, the eraser included.")
IMMOVABLE = Type("immovable", description="A piece of furniture, which stays where it stands.")
TABLE = Type("table", parent=IMMOVABLE)
TRASH_CAN = Type("trash_can", parent=IMMOVABLE, description="A bin that is open at the top.")
TYPES = (ROBOT, MOVABLE, IMMOVABLE, TABLE, TRASH_CAN)

PICK_FROM_TOP = Skill(
    "PickFromTop",
    (ROBOT, MOVABLE, IMMOVABLE),
    description=(
        "The robot, its hand empty, takes the thing that lies on top of the piece of furniture, or in a wide open "
        "container; from a narrow one it can take nothing."
    ),
)
PLACE_INSIDE = Skill(
    "PlaceInside",
    (ROBOT, MOVABLE, TRASH_CAN),
    description="The robot lets go of the thing it holds over the open container, so that it lies inside.",
)
PICK_FROM_FLOOR = Skill(
    "PickFromFloor", (ROBOT, MOVABLE), description="The robot, its hand empty, takes the thing that lies on the floor."
)
WIPE = Skill(
    "WipeAndContinueHoldingEraser",
    (ROBOT, MOVABLE, TABLE),
    description=(
        "The robot wipes the scribbles off the table with the eraser it holds, and goes on holding it; scribbles "
        "beside a thing that stands on the table stay."
    ),
)
DUMP = Skill(
    "DumpContentsOntoFloor",
    (ROBOT, TRASH_CAN),
    description="The robot, its hand empty, turns the container over, so that what was inside lies on the floor.",
)
SKILLS = (PICK_FROM_TOP, PLACE_INSIDE, PICK_FROM_FLOOR, WIPE, DUMP)

HOLDING = Predicate("Holding", (ROBOT, MOVABLE), FromDomain(), description="The robot has the thing in its hand.")
HAND_EMPTY = Predicate("HandEmpty", (ROBOT,), FromDomain(), description="The robot has nothing in its hand.")
INSIDE_CONTAINER = Predicate(
    "InsideContainer",
    (MOVABLE, TRASH_CAN),
    FromVLM("InsideContainer"),
    description="The thing lies inside the container; a thing that is held over it does not.",
)
WIPED = Predicate(
    "WipedOfMarkerScribbles",
    (TABLE,),
    FromVLM("WipedOfMarkerScribbles"),
    description="There is no scribble on the top of the table.",
)
GIVEN = (HOLDING, HAND_EMPTY, INSIDE_CONTAINER, WIPED)
