"""What a world model knows beside its operators: how far labels can be trusted, and what always holds."""

from pix2pred.structs.knowledge.invariants import Implication, Invariant, MutexGroup
from pix2pred.structs.knowledge.reliability import Reliability

__all__ = ["Implication", "Invariant", "MutexGroup", "Reliability"]
