"""The one door to every model."""

from pix2pred.vlm.flow import FlowSettings
from pix2pred.vlm.request import VLM, Answer, Finish, NoAnswerError, Request, Review, Reviewer, Spent, Token, VLMError
from pix2pred.vlm.store import AnswerStore
from pix2pred.vlm.stored import ReplayMissError, StoredVLM, StoreMode
from pix2pred.vlm.usage import CountingVLM, Usage

__all__ = [
    "VLM",
    "Answer",
    "AnswerStore",
    "CountingVLM",
    "Finish",
    "FlowSettings",
    "NoAnswerError",
    "ReplayMissError",
    "Request",
    "Review",
    "Reviewer",
    "Spent",
    "StoreMode",
    "StoredVLM",
    "Token",
    "Usage",
    "VLMError",
]
