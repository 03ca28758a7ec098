"""A circuit breaker: a model that keeps refusing or answering nonsense is not asked any further."""

from __future__ import annotations

import threading

from pix2pred.system.errors import StoppedError
from pix2pred.vlm.request import VLM, Answer, Finish, NoAnswerError, Request, Stoppable, VLMError


class UselessModelError(StoppedError, VLMError):
    """Too many answers in a row from which nothing could be read."""


class BreakerVLM:
    """Ends the run after ``limit`` unusable answers in a row; an answer is judged by the request's ``review``.

    It is the next question that meets the error: the last answer is handed on, so that it is stored.
    """

    def __init__(self, model: VLM, limit: int) -> None:
        self.name = model.name
        self._model = model
        self._limit = limit
        self._useless: list[str] = []
        self._lock = threading.Lock()

    def answer(self, request: Request) -> Answer:
        """The model's answer. Raises ``UselessModelError`` with the count and two examples."""
        with self._lock:
            self._check()
        try:
            answer = self._model.answer(request)
        except NoAnswerError as error:
            self._count(f"no answer: {error}")
            raise
        if answer.finish not in (Finish.CUT_SHORT, Finish.TOO_LARGE):  # that will be asked for in parts
            self._count(_what_is_wrong(request, answer))
        return answer

    def stop(self) -> None:
        """End all waiting: the run is over."""
        if isinstance(self._model, Stoppable):
            self._model.stop()

    def _count(self, problem: str) -> None:
        with self._lock:
            if len(self._useless) < self._limit:  # answers under way do not close what has opened
                self._useless = [*self._useless, problem] if problem else []

    def _check(self) -> None:
        if len(self._useless) >= self._limit:
            examples = "; ".join(f"({n}) {text}" for n, text in enumerate(self._useless[:2], start=1))
            raise UselessModelError(
                f"{self.name}: {len(self._useless)} answers in a row were of no use, so the run was stopped. "
                f"Two of them: {examples}. Stored answers are kept; --mode retry asks again what was refused or "
                "cut short, --mode live everything"
            )


def _what_is_wrong(request: Request, answer: Answer) -> str:
    """An example for people; empty for an answer of use."""
    said = " ".join(answer.text.split())
    if answer.finish == Finish.REFUSED:
        return f"refused: {said[:120]!r}"
    if not said:
        return "an empty answer"
    review = request.review(answer.text) if request.review else None
    return f"{said[:120]!r} ({review.problem[:120]})" if review and not review.usable else ""
