"""Types, skills and given predicates of the juice domain (method 10.5). There are no object features."""

from __future__ import annotations

from pix2pred.structs import FromDomain, FromVLM, Predicate, Skill, Type

ROBOT = Type("robot")
JUICER = Type("juicer")
CONTAINER = Type("container", description="A cup or bowl that juice or waste can be caught in.")
MOVABLE = Type("movable_object", description="A fruit, or another thing that can be put into a juicer.")
TYPES = (ROBOT, JUICER, CONTAINER, MOVABLE)

PICK_CONTAINER = Skill(
    "PickContainer",
    (ROBOT, CONTAINER),
    description="The robot, its hand empty, takes the vessel; what is in it stays in it.",
)
PICK_MOVABLE = Skill(
    "PickMovable",
    (ROBOT, MOVABLE),
    description="The robot, its hand empty, takes the fruit, which is not in the juicer.",
)
PLACE_IN_WASTE_REGION = Skill(
    "PlaceInsideWasteValveRegion",
    (ROBOT, CONTAINER, JUICER),
    description="The robot puts the vessel it holds into the region marked blue under the juicer's waste valve.",
)
PLACE_IN_JUICE_REGION = Skill(
    "PlaceInsideJuiceValveRegion",
    (ROBOT, CONTAINER, JUICER),
    description="The robot puts the vessel it holds into the region marked orange under the juicer's juice valve.",
)
PLACE_INSIDE = Skill(
    "PlaceInside",
    (ROBOT, MOVABLE, JUICER),
    description="The robot lets the fruit it holds fall into the juicer, whose lid has to be open.",
)
POUR = Skill(
    "DumpFromOneIntoOther",
    (ROBOT, CONTAINER, CONTAINER),
    description="The robot pours what is in the first vessel, which it holds, into the second, which has to be empty.",
)
CLOSE_LID = Skill(
    "CloseLid", (ROBOT, JUICER), description="The robot, its hand empty, closes the open lid of the juicer."
)
RUN = Skill(
    "TurnOnAndRunMachine",
    (ROBOT, JUICER, CONTAINER, CONTAINER),
    description=(
        "The robot starts the closed juicer, which fills the first vessel, under the juice valve, with the juice of "
        "the fruit inside, and the second, under the waste valve, with pulp; both have to be empty before."
    ),
)
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

HOLDING_CONTAINER = Predicate(
    "HoldingContainer", (ROBOT, CONTAINER), FromDomain(), description="The robot has the vessel in its hand."
)
HOLDING_OBJ = Predicate(
    "HoldingObj", (ROBOT, MOVABLE), FromDomain(), description="The robot has the fruit in its hand."
)
HAND_EMPTY = Predicate("HandEmpty", (ROBOT,), FromDomain(), description="The robot has nothing in its hand.")
JUICE_IN_CUP = Predicate(
    "JuiceInCup", (MOVABLE, CONTAINER), FromVLM("JuiceInCup"), description="The juice of the fruit is in the vessel."
)
EMPTY = Predicate(
    "Empty", (CONTAINER,), FromVLM("Empty"), description="Nothing is in the vessel: no juice and no pulp."
)
INSIDE = Predicate(
    "Inside", (MOVABLE, JUICER), FromVLM("Inside"), description="The fruit lies whole inside the juicer."
)
GIVEN = (HOLDING_CONTAINER, HOLDING_OBJ, HAND_EMPTY, JUICE_IN_CUP, EMPTY, INSIDE)
