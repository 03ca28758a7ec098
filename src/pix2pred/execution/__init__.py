"""Solving tasks with a world model: abstract, plan, execute, and say why when it fails."""

from pix2pred.execution.diagnosis import TruthOf
from pix2pred.execution.guided import Guided, Look
from pix2pred.execution.missing import Missing
from pix2pred.execution.rests import Need
from pix2pred.execution.runner import Solver
from pix2pred.execution.scene import PlannedScene, plan_scene

__all__ = ["Guided", "Look", "Missing", "Need", "PlannedScene", "Solver", "TruthOf", "plan_scene"]
