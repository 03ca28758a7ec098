"""From labels to operators and selected predicates. Nothing here asks a model or sees a picture."""

from pix2pred.learning.labels.advice import Advice, LabelAdvice, advice_document, advise
from pix2pred.learning.operators.support import Support, SupportKind, operator_support
from pix2pred.learning.selection.document import selection_document
from pix2pred.learning.selection.hill_climbing import HillClimbing
from pix2pred.learning.selection.result import ClimbEnd, ClimbStep, RunnerUp, Selection
from pix2pred.learning.settings import LearningSettings
from pix2pred.learning.strategies import hill_climbing, learn_operators
from pix2pred.structs.formats.traces import Traces, TracesError, dump_traces, load_traces

__all__ = [
    "Advice",
    "ClimbEnd",
    "ClimbStep",
    "HillClimbing",
    "LabelAdvice",
    "LearningSettings",
    "RunnerUp",
    "Selection",
    "Support",
    "SupportKind",
    "Traces",
    "TracesError",
    "advice_document",
    "advise",
    "dump_traces",
    "hill_climbing",
    "learn_operators",
    "load_traces",
    "operator_support",
    "selection_document",
]
