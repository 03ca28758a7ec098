"""What ``--detector`` names for a Spot: a model beside the robot, the model that labels, or one on this machine."""

from __future__ import annotations

from pix2pred.robots.detecting.by_transformers import TransformersDetector, TransformersSegmenter
from pix2pred.robots.detecting.by_vlm import VLMDetector
from pix2pred.robots.robot import Outcome, RobotError
from pix2pred.robots.spot.finding import ByBridge, ByWords, Outliner
from pix2pred.robots.spot.session import SpotSession
from pix2pred.vlm import VLM


def by_bridge(session: SpotSession, model: str, vlm: VLM) -> Outliner:
    """A model behind the robot's network-compute bridge, that answers with outlines."""
    if not model:
        raise RobotError(Outcome.NOT_READY, "--detector bridge: name its model, as in bridge:my-detector")
    return ByBridge(session, model)


def by_vlm(session: SpotSession, options: str, vlm: VLM) -> Outliner:
    """The model that labels, asked for boxes; what is in a box counts as the object."""
    return ByWords(VLMDetector(vlm))


def by_transformers(session: SpotSession, models: str, vlm: VLM) -> Outliner:
    """A detector, and after a comma a segmenter."""
    detector, _, segmenter = models.partition(",")
    if not detector:
        raise RobotError(Outcome.NOT_READY, "--detector transformers: name a model, as in transformers:FOLDER[,FOLDER]")
    return ByWords(TransformersDetector(detector), TransformersSegmenter(segmenter) if segmenter else None)
