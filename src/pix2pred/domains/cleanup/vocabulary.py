"""Types, skills and given predicates of the cleanup domain (method 10.4). There are no object features."""

from __future__ import annotations

from pix2pred.structs import FromDomain, FromVLM, Predicate, Skill, Type

ROBOT = Type("robot")
MOVABLE = Type("movable_object")
IMMOVABLE = Type("immovable")
TABLE = Type("table", parent=IMMOVABLE)
TRASH_CAN = Type("trash_can", parent=IMMOVABLE)
TYPES = (ROBOT, MOVABLE, IMMOVABLE, TABLE, TRASH_CAN)

PICK_FROM_TOP = Skill("PickFromTop", (ROBOT, MOVABLE, IMMOVABLE))
PLACE_INSIDE = Skill("PlaceInside", (ROBOT, MOVABLE, TRASH_CAN))
PICK_FROM_FLOOR = Skill("PickFromFloor", (ROBOT, MOVABLE))
WIPE = Skill("WipeAndContinueHoldingEraser", (ROBOT, MOVABLE, TABLE))
DUMP = Skill("DumpContentsOntoFloor", (ROBOT, TRASH_CAN))
SKILLS = (PICK_FROM_TOP, PLACE_INSIDE, PICK_FROM_FLOOR, WIPE, DUMP)

HOLDING = Predicate("Holding", (ROBOT, MOVABLE), FromDomain())
HAND_EMPTY = Predicate("HandEmpty", (ROBOT,), FromDomain())
INSIDE_CONTAINER = Predicate("InsideContainer", (MOVABLE, TRASH_CAN), FromVLM("InsideContainer"))
WIPED = Predicate("WipedOfMarkerScribbles", (TABLE,), FromVLM("WipedOfMarkerScribbles"))
GIVEN = (HOLDING, HAND_EMPTY, INSIDE_CONTAINER, WIPED)
