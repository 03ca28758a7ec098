"""Types, skills and given predicates of the juice domain (method 10.5). There are no object features."""

from __future__ import annotations

from pix2pred.structs import FromDomain, FromVLM, Predicate, Skill, Type

ROBOT = Type("robot")
JUICER = Type("juicer")
CONTAINER = Type("container")
MOVABLE = Type("movable_object")
TYPES = (ROBOT, JUICER, CONTAINER, MOVABLE)

PICK_CONTAINER = Skill("PickContainer", (ROBOT, CONTAINER))
PICK_MOVABLE = Skill("PickMovable", (ROBOT, MOVABLE))
PLACE_IN_WASTE_REGION = Skill("PlaceInsideWasteValveRegion", (ROBOT, CONTAINER, JUICER))
PLACE_IN_JUICE_REGION = Skill("PlaceInsideJuiceValveRegion", (ROBOT, CONTAINER, JUICER))
PLACE_INSIDE = Skill("PlaceInside", (ROBOT, MOVABLE, JUICER))
POUR = Skill("DumpFromOneIntoOther", (ROBOT, CONTAINER, CONTAINER))
CLOSE_LID = Skill("CloseLid", (ROBOT, JUICER))
RUN = Skill("TurnOnAndRunMachine", (ROBOT, JUICER, CONTAINER, CONTAINER))
SKILLS = (
    PICK_CONTAINER,
    PICK_MOVABLE,
    PLACE_IN_WASTE_REGION,
    PLACE_IN_JUICE_REGION,
    PLACE_INSIDE,
    POUR,
    CLOSE_LID,
    RUN,
)

HOLDING_CONTAINER = Predicate("HoldingContainer", (ROBOT, CONTAINER), FromDomain())
HOLDING_OBJ = Predicate("HoldingObj", (ROBOT, MOVABLE), FromDomain())
HAND_EMPTY = Predicate("HandEmpty", (ROBOT,), FromDomain())
JUICE_IN_CUP = Predicate("JuiceInCup", (MOVABLE, CONTAINER), FromVLM("JuiceInCup"))
EMPTY = Predicate("Empty", (CONTAINER,), FromVLM("Empty"))
INSIDE = Predicate("Inside", (MOVABLE, JUICER), FromVLM("Inside"))
GIVEN = (HOLDING_CONTAINER, HOLDING_OBJ, HAND_EMPTY, JUICE_IN_CUP, EMPTY, INSIDE)
