"""Flow control: how many requests are under way at once, and what happens when one fails.

Requests wait for one of ``concurrent`` places. A failure that may pass is tried again after an exponentially growing
pause with full jitter, between zero and a cap; a server that says how long to wait is obeyed, by all threads.
"""

from __future__ import annotations

import logging
import random
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from pix2pred.vlm.control.together import PLACES
from pix2pred.vlm.request import VLM, Answer, NoAnswerError, Request, Spent, Stoppable, VLMError


class FlowSettings(BaseModel):
    """How a model is asked; never what it answers."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    concurrent: int = Field(PLACES, ge=1, le=1024, description="requests under way at once")
    timeout: float = Field(180.0, gt=0, description="seconds until a request counts as lost")
    tries: int = Field(10, ge=1, description="requests for one question before it stays without an answer")
    first_pause: float = Field(1.0, ge=0, description="seconds; longest pause after a first failure, then doubled")
    longest_pause: float = Field(60.0, ge=0, description="seconds; cap of the doubling")
    max_atoms: int = Field(
        100_000, ge=1, description="atoms of one demonstration that are labelled; more end the run before it asks"
    )
    max_wait: float = Field(
        600.0, ge=0, le=86_400, description="seconds; a server that asks to wait longer ends the run, which can go on"
    )
    unusable_in_a_row: int = Field(10, ge=1, description="useless answers, one after the other, that end the run")
    output_tokens: int | None = Field(
        None, ge=16, le=1_000_000, description="budget of every answer, in place of the one a question comes with"
    )
    thinking: int | None = Field(
        None, ge=0, le=1_000_000,
        description="tokens for thinking beside the answer's budget; 0: not to think; null: as the model usually needs",
    )  # fmt: skip
    temperature: Literal["asked"] | None = Field(
        "asked", description="null: send no temperature, for models that take their own alone"
    )
    max_pictures: int | None = Field(None, ge=1, le=10_000, description="most pictures that a question may show")
    beyond_estimate: float = Field(
        3.0, ge=1, le=1e6, description="times what a dry run says that may be spent before the run stops and asks"
    )


class TransientError(VLMError):
    """A failure that may pass: overload, a cut connection, an answer that is not what the protocol promises.

    ``retry_after`` is how many seconds the server asks to wait; ``connected`` tells that there is a server of models.
    """

    def __init__(self, message: str, retry_after: float | None = None, *, connected: bool = True) -> None:
        super().__init__(message)
        self.retry_after = retry_after
        self.connected = connected


_HOPELESS = 4
"""Failures to connect after which a server that never answered is taken for absent."""
_TOLD = 10.0
"""Seconds: waiting that a person is told of, since nothing moves meanwhile."""
_LONGEST_TOLD = 1e9
"""Seconds: longer waiting is shown as this."""
_LOG = logging.getLogger("pix2pred")


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
        wasted: list[Spent] = []
        for number in range(1, self._settings.tries + 1):
            with self._places:
                self._wait_for_turn()
                try:
                    answer = self._model.answer(request)
                except TransientError as error:
                    failure = error
                else:
                    self._reached = True
                    return replace(answer, spent=_sum((answer.spent, *wasted))) if wasted else answer
            self._reached |= failure.connected
            if failure.spent is not None:
                wasted.append(failure.spent)
            if not self._reached and number >= min(_HOPELESS, self._settings.tries):
                raise VLMError(f"{self.name}: {failure}; is the address right and the server running?") from failure
            self._note(failure)
            if number < self._settings.tries:
                self._pause(self._after(number) if failure.retry_after is None else failure.retry_after)
        raise NoAnswerError(f"{failure}, {self._settings.tries} times") from failure

    def hold(self, seconds: float) -> None:
        """Let no request out for ``seconds``: a provider said that its allowance is used up."""
        with self._lock:
            self._not_before = max(self._not_before, self._clock() + seconds)
        if seconds >= _TOLD:
            _LOG.warning("%s: the server asks to wait %.0f s", self.name, min(seconds, _LONGEST_TOLD))

    def stop(self) -> None:
        """End all waiting: the run is over."""
        self._stopped.set()
        if isinstance(self._model, Stoppable):
            self._model.stop()

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
        if not seconds <= self._settings.max_wait:
            raise VLMError(
                f"{self.name}: the server asks to wait {min(seconds, _LONGEST_TOLD):,.0f} s, longer than "
                f"{self._settings.max_wait:g} s (flow: {{max_wait: ...}}); answers so far are stored, and the same "
                "command goes on from there"
            )
        if self._stopped.wait(seconds):
            raise NoAnswerError("the run was ended while this question waited to be asked again")


def _sum(parts: Sequence[Spent]) -> Spent:
    """What several answers took together; the price is unknown only when it is of all."""
    priced = [p.dollars for p in parts if p.dollars is not None]
    return Spent(
        sum(p.input_tokens for p in parts),
        sum(p.output_tokens for p in parts),
        sum(priced) if priced else None,
        sum(p.seconds for p in parts),
    )
