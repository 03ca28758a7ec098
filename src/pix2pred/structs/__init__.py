"""The nouns: types, objects, predicates, atoms, states, skills, demonstrations, operators, models."""

from pix2pred.structs.demos import Demo, Task, Vocabulary
from pix2pred.structs.objects import Object, Type, Variable, count_groundings, groundings
from pix2pred.structs.operators import GroundOperator, Operator
from pix2pred.structs.plans import Episode, ExecutedStep, Failure, PlanResult, PlanStatus, Question, Turn, WhyAsked
from pix2pred.structs.predicates import (
    Application,
    Atom,
    FromDomain,
    FromFeatures,
    FromHuman,
    FromOpposite,
    FromSkills,
    FromVLM,
    LiftedAtom,
    Predicate,
    SkillTrigger,
    parse_application,
)
from pix2pred.structs.skills import Action, Skill
from pix2pred.structs.states import AbstractState, Box, Image, Picture, PictureError, Pixels, State
from pix2pred.structs.truth_table import Candidate, Label, LabelledDemo, TruthTable, unknown_as_false
from pix2pred.structs.world_model import WorldModel

__all__ = [
    "AbstractState",
    "Action",
    "Application",
    "Atom",
    "Box",
    "Candidate",
    "Demo",
    "Episode",
    "ExecutedStep",
    "Failure",
    "FromDomain",
    "FromFeatures",
    "FromHuman",
    "FromOpposite",
    "FromSkills",
    "FromVLM",
    "GroundOperator",
    "Image",
    "Label",
    "LabelledDemo",
    "LiftedAtom",
    "Object",
    "Operator",
    "Picture",
    "PictureError",
    "Pixels",
    "PlanResult",
    "PlanStatus",
    "Predicate",
    "Question",
    "Skill",
    "SkillTrigger",
    "State",
    "Task",
    "TruthTable",
    "Turn",
    "Type",
    "Variable",
    "Vocabulary",
    "WhyAsked",
    "WorldModel",
    "count_groundings",
    "groundings",
    "parse_application",
    "unknown_as_false",
]  # fmt: skip
