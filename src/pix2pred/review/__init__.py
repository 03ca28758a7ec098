"""Correcting a run in the browser: a loopback server for the report, and the append-only file of corrections."""

from pix2pred.review.log import CorrectionLog, StaleError
from pix2pred.review.server import ReviewServer

__all__ = ["CorrectionLog", "ReviewServer", "StaleError"]
