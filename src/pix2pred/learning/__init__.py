"""From labels to operators and selected predicates. Nothing here asks a model or sees a picture."""

from pix2pred.learning.advice import Advice, LabelAdvice, advice_document, advise
from pix2pred.learning.document import selection_document
from pix2pred.learning.engines import hill_climbing, learn_operators, operator_learner, skeleton_search, tie_rule
from pix2pred.learning.readings import Reading, Verdict, readings
from pix2pred.learning.selection import HillClimbing, RunnerUp, Selection, Step, TieRule
from pix2pred.learning.settings import LearningSettings
from pix2pred.learning.traces import Traces, TracesError, dump_traces, load_traces

__all__ = [
    "Advice",
    "HillClimbing",
    "LabelAdvice",
    "LearningSettings",
    "Reading",
    "RunnerUp",
    "Selection",
    "Step",
    "TieRule",
    "Traces",
    "TracesError",
    "Verdict",
    "advice_document",
    "advise",
    "dump_traces",
    "hill_climbing",
    "learn_operators",
    "load_traces",
    "operator_learner",
    "readings",
    "selection_document",
    "skeleton_search",
    "tie_rule",
]
