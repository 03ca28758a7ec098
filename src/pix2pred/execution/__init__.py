"""Solving tasks with a world model: abstract, plan, execute, and say why when it fails."""

from pix2pred.execution.explaining.diagnosis import TruthOf
from pix2pred.execution.explaining.missing import Missing
from pix2pred.execution.explaining.rests import Need
from pix2pred.execution.explaining.scene import PlannedScene, plan_scene
from pix2pred.execution.guided import Guided, SeenStep
from pix2pred.execution.pursuit import assume_all
from pix2pred.execution.solver import Solver

__all__ = ["Guided", "Missing", "Need", "PlannedScene", "SeenStep", "Solver", "TruthOf", "assume_all", "plan_scene"]
