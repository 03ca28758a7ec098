"""The one door to every model."""

from pix2pred.vlm.answers.store import AnswerStore
from pix2pred.vlm.answers.stored import ReplayMissError, StoredVLM, StoreMode
from pix2pred.vlm.control.flow import FlowSettings
from pix2pred.vlm.control.together import Together
from pix2pred.vlm.control.usage import CountingVLM, Usage
from pix2pred.vlm.request import (
    VLM,
    Answer,
    Finish,
    NoAnswerError,
    Purpose,
    Request,
    Review,
    Reviewer,
    Spent,
    Token,
    VLMError,
)

__all__ = [
    "VLM",
    "Answer",
    "AnswerStore",
    "CountingVLM",
    "Finish",
    "FlowSettings",
    "NoAnswerError",
    "Purpose",
    "ReplayMissError",
    "Request",
    "Review",
    "Reviewer",
    "Spent",
    "StoreMode",
    "StoredVLM",
    "Together",
    "Token",
    "Usage",
    "VLMError",
]
