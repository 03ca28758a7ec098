"""``replay:DIR``: the model whose answers a folder holds, without the model."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from pix2pred.system.files import read_regular
from pix2pred.vlm.answers.store import AnswerStore
from pix2pred.vlm.model_spec import Kind, ModelSpec, Setup
from pix2pred.vlm.request import VLM, Answer, Request, VLMError


@dataclass(frozen=True, slots=True)
class ReplaySpec(ModelSpec):
    """The answers of a folder instead of the model that gave them."""

    directory: Path

    def connect(self, setup: Setup) -> VLM:
        """The model by name. Raises ``VLMError`` when the folder holds no answers, or those of several models."""
        return replayed(AnswerStore(self.directory))

    @property
    def own_answers(self) -> Path:
        return self.directory


REPLAY = Kind("replay:DIR", lambda rest: ReplaySpec(Path(rest)))


class AbsentVLM:
    """A model known by name alone: for stores that are replayed."""

    def __init__(self, name: str) -> None:
        self.name = name

    def answer(self, request: Request) -> Answer:
        """Never answers. Raises ``VLMError``."""
        raise VLMError(f"{self.name}: is replayed and cannot be asked")


def stored_models(store: AnswerStore) -> list[str]:
    """The models whose answers are in the store, sorted. Raises ``VLMError`` for a damaged file."""
    models = set()
    for key in store.all_keys():
        path = store.path(key)
        try:
            models.add(str(json.loads(read_regular(path))["request"]["model"]))
        except (ValueError, KeyError, TypeError) as error:
            raise VLMError(f"{path}: damaged answer ({error}); see 'pix2pred answers verify'") from error
    return sorted(models)


def replayed(store: AnswerStore) -> AbsentVLM:
    """The one model of the store. Raises ``VLMError`` when there is none, or more than one."""
    models = stored_models(store)
    if not models:
        raise VLMError(f"{store.directory}: holds no answers to replay")
    if len(models) > 1:
        raise VLMError(
            f"{store.directory}: holds answers of {', '.join(models)}; say which one with "
            f"--vlm MODEL --answers {store.directory} --mode replay"
        )
    return AbsentVLM(models[0])
