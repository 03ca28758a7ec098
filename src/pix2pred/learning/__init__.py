"""From labels to operators and selected predicates. Nothing here asks a model or sees a picture."""

from pix2pred.learning.labels.advice import Advice, LabelAdvice, advice_document, advise
from pix2pred.learning.operators.support import Reading, Verdict, readings
from pix2pred.learning.selection.document import selection_document
from pix2pred.learning.selection.hill_climbing import HillClimbing, RunnerUp, Selection, Step
from pix2pred.learning.selection.stopping_rules import ClimbingRule, Explained, Published
from pix2pred.learning.settings import LearningSettings
from pix2pred.learning.strategies import (
    climbing_rule,
    hill_climbing,
    learn_operators,
    operator_learner,
    skeleton_search,
)
from pix2pred.structs.formats.traces import Traces, TracesError, dump_traces, load_traces

__all__ = [
    "Advice",
    "ClimbingRule",
    "Explained",
    "HillClimbing",
    "LabelAdvice",
    "LearningSettings",
    "Published",
    "Reading",
    "RunnerUp",
    "Selection",
    "Step",
    "Traces",
    "TracesError",
    "Verdict",
    "advice_document",
    "advise",
    "climbing_rule",
    "dump_traces",
    "hill_climbing",
    "learn_operators",
    "load_traces",
    "operator_learner",
    "readings",
    "selection_document",
    "skeleton_search",
]
