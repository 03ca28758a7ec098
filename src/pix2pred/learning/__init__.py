"""From labels to operators and selected predicates. Nothing here asks a model or sees a picture."""

from pix2pred.learning.document import selection_document
from pix2pred.learning.engines import skeleton_search, tie_rule
from pix2pred.learning.operators import learn_operators
from pix2pred.learning.selection import HillClimbing, RunnerUp, Selection, Step, TieRule
from pix2pred.learning.settings import LearningSettings
from pix2pred.learning.traces import Traces, TracesError, dump_traces, load_traces

__all__ = [
    "HillClimbing",
    "LearningSettings",
    "RunnerUp",
    "Selection",
    "Step",
    "TieRule",
    "Traces",
    "TracesError",
    "dump_traces",
    "learn_operators",
    "load_traces",
    "selection_document",
    "skeleton_search",
    "tie_rule",
]
