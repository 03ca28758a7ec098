"""A model behind an answer store: what is stored is not asked, what is asked is stored before it is used."""

from __future__ import annotations

import threading
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum

from pix2pred.vlm.answers.renamed import RenamedQuestions
from pix2pred.vlm.answers.store import AnswerStore
from pix2pred.vlm.request import VLM, Answer, Finish, NoAnswerError, Request, Stoppable, VLMError


class StoreMode(StrEnum):
    """Which questions go to the model although a store is there."""

    LIVE = "live"
    """All of them."""
    RESUME = "resume"
    """Those that have no stored answer."""
    RETRY = "retry"
    """These, and those whose stored answer was refused or cut
    short."""
    REPLAY = "replay"
    """None."""


class ReplayMissError(VLMError):
    """A question that the store has no answer to, in replay mode."""


class StoredVLM:
    """A model behind an answer store.

    The first error that ends the run also ends the asking: no new question goes out, and the error is raised only
    when the answers under way have arrived and are stored. Questions without an
    answer are stored as such, so that a replay meets the same gaps; resuming asks them again.
    """

    def __init__(self, model: VLM, store: AnswerStore, mode: StoreMode = StoreMode.RESUME) -> None:
        self.name = model.name
        self._model = model
        self._store = store
        self._mode = mode
        self._under_way = 0
        self._settled = threading.Condition()
        self._ended: VLMError | None = None
        self._asking: defaultdict[str, threading.Lock] = defaultdict(threading.Lock)
        self._writable = False
        self._renamed = RenamedQuestions(store)

    def answer(self, request: Request) -> Answer:
        """The stored answer if the mode allows, else the model's, stored before it is returned."""
        key = request.key(self.name)
        if (stored := self._stored(key)) is not None or (stored := self._of_renamed(request)) is not None:
            return stored
        if self._mode == StoreMode.REPLAY:
            raise ReplayMissError(
                f"the store {self._store.directory} has no answer to a {request.purpose} query of {self.name} "
                f"(key {key[:12]}); run once with --mode resume to ask the model"
            )
        with self._settled:
            asking = self._asking[key]
        with asking:  # the same question from two threads goes out once
            if (stored := self._stored(key)) is not None:
                return stored
            with self._orderly():
                return self._ask(request)

    def _stored(self, key: str) -> Answer | None:
        if self._mode == StoreMode.LIVE or (answer := self._store.get(key)) is None:
            return None
        if answer.finish == Finish.NONE:
            if self._mode == StoreMode.REPLAY:
                raise NoAnswerError(answer.text)
            return None
        return None if self._mode == StoreMode.RETRY and answer.finish != Finish.COMPLETE else answer

    def _of_renamed(self, request: Request) -> Answer | None:
        """The stored answer to the same question with other names of types, kept under this question's key too."""
        if self._mode == StoreMode.LIVE or (key := self._renamed.key(request, self.name)) is None:
            return None
        if (answer := self._stored(key)) is not None and self._mode != StoreMode.REPLAY:
            self._store.put(request, self.name, answer)
        return answer

    def _ask(self, request: Request) -> Answer:
        if not self._writable:
            self._store.check_writable()
            self._writable = True
        try:
            answer = self._model.answer(request)
        except NoAnswerError as error:
            self._store.put(request, self.name, Answer(str(error), finish=Finish.NONE))
            raise
        self._store.put(request, self.name, answer)
        return answer

    @contextmanager
    def _orderly(self) -> Iterator[None]:
        with self._settled:
            if self._ended is not None:
                raise self._ended
            self._under_way += 1
        try:
            yield
        except NoAnswerError:
            raise
        except VLMError as error:
            with self._settled:
                self._ended = self._ended or error
            if isinstance(self._model, Stoppable):
                self._model.stop()
            raise
        finally:
            with self._settled:
                self._under_way -= 1
                self._settled.notify_all()
                if self._ended is not None:
                    self._settled.wait_for(lambda: self._under_way == 0)
