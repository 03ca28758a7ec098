"""Flow control: how many requests are under way at once, and what happens when one fails.

Requests wait for one of ``concurrent`` places. A failure that may pass is tried again after an exponentially growing
pause with full jitter, between zero and a cap; a server that says how long to wait is obeyed, by all threads.
"""

from __future__ import annotations

import random
import threading
import time
from collections.abc import Callable

from pydantic import BaseModel, ConfigDict, Field

from pix2pred.vlm.request import VLM, Answer, NoAnswerError, Request, VLMError


class FlowSettings(BaseModel):
    """How a model is asked; never what it answers."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    concurrent: int = Field(8, ge=1, description="requests under way at once, and demonstrations labelled at once")
    timeout: float = Field(180.0, gt=0, description="seconds until a request counts as lost")
    tries: int = Field(10, ge=1, description="requests for one question before it stays without an answer")
    first_pause: float = Field(1.0, ge=0, description="seconds; longest pause after a first failure, then doubled")
    longest_pause: float = Field(60.0, ge=0, description="seconds; cap of the doubling")
    max_atoms: int = Field(
        100_000, ge=1, description="atoms of one demonstration that are labelled; more end the run before it asks"
    )
    unusable_in_a_row: int = Field(10, ge=1, description="useless answers, one after the other, that end the run")


class TransientError(VLMError):
    """A failure that may pass: overload, a cut connection, an answer that is not what the protocol promises.

    ``retry_after`` is how many seconds the server asks to wait; ``connected`` tells that there is a server.
    """

    def __init__(self, message: str, retry_after: float | None = None, *, connected: bool = True) -> None:
        super().__init__(message)
        self.retry_after = retry_after
        self.connected = connected


_HOPELESS = 4
"""Failures to connect after which a server that never answered is taken for absent."""


class FlowVLM:
    """A model asked with a limit, pauses and repetitions."""

    def __init__(
        self,
        model: VLM,
        settings: FlowSettings,
        *,
        clock: Callable[[], float] = time.monotonic,
        jitter: Callable[[], float] = random.random,
    ) -> None:
        self.name = model.name
        self._model = model
        self._settings = settings
        self._clock = clock
        self._jitter = jitter
        self._places = threading.Semaphore(settings.concurrent)
        self._stopped = threading.Event()
        self._not_before = 0.0
        self._lock = threading.Lock()
        self._reached = False

    def answer(self, request: Request) -> Answer:
        """The model's answer. Raises ``NoAnswerError`` when every try failed, ``VLMError`` when nothing can work."""
        for number in range(1, self._settings.tries + 1):
            with self._places:
                self._wait_for_turn()
                try:
                    answer = self._model.answer(request)
                except TransientError as error:
                    failure = error
                else:
                    self._reached = True
                    return answer
            self._reached |= failure.connected
            if not self._reached and number >= min(_HOPELESS, self._settings.tries):
                raise VLMError(f"{self.name}: {failure}; is the address right and the server running?") from failure
            self._note(failure)
            if number < self._settings.tries:
                self._pause(self._after(number) if failure.retry_after is None else failure.retry_after)
        raise NoAnswerError(f"{failure}, {self._settings.tries} times") from failure

    def hold(self, seconds: float) -> None:
        """Let no request out for ``seconds``: a provider said that its allowance is used up."""
        with self._lock:
            self._not_before = max(self._not_before, self._clock() + min(seconds, 600.0))

    def stop(self) -> None:
        """End all waiting: the run is over."""
        self._stopped.set()

    def _note(self, failure: TransientError) -> None:
        if failure.retry_after is not None:
            self.hold(failure.retry_after)

    def _after(self, number: int) -> float:
        longest = min(self._settings.longest_pause, self._settings.first_pause * 2.0 ** (number - 1))
        return longest * self._jitter()

    def _wait_for_turn(self) -> None:
        while (left := self._not_before - self._clock()) > 0:
            self._pause(left)

    def _pause(self, seconds: float) -> None:
        if self._stopped.wait(min(seconds, 600.0)):
            raise NoAnswerError("the run was ended while this question waited to be asked again")
