"""The one door to every model."""

from pix2pred.vlm.request import VLM, Answer, Request, VLMError
from pix2pred.vlm.store import AnswerStore, ReplayMissError, StoredVLM, StoreMode
from pix2pred.vlm.usage import CountingVLM, Usage

__all__ = [
    "VLM",
    "Answer",
    "AnswerStore",
    "CountingVLM",
    "ReplayMissError",
    "Request",
    "StoreMode",
    "StoredVLM",
    "Usage",
    "VLMError",
]
