"""Solving tasks with a world model: abstract, plan, execute, and say why when it fails."""

from pix2pred.execution.diagnosis import TruthOf
from pix2pred.execution.runner import Solver

__all__ = ["Solver", "TruthOf"]
