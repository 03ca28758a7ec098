"""Spending far beyond what a dry run says is stopped: something is wrong that no single answer shows."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass

from pix2pred.system.errors import StoppedError
from pix2pred.vlm.request import VLM, Answer, Purpose, Request, Stoppable, VLMError


@dataclass(frozen=True, slots=True)
class Expected:
    """What a dry run says will still be asked: questions, tokens of answers, and dollars where the price is known."""

    questions: int
    output_tokens: int
    dollars: float | None


Estimate = Callable[[], Expected | None]
"""A dry run of what is not stored yet; ``None`` when none can be made."""


class BeyondEstimateError(StoppedError, VLMError):
    """Much more was spent than the dry run said. What was answered is stored."""


class GuardVLM:
    """Ends the run when it has spent more than ``times`` what ``estimate`` says.

    The estimate is made before the first question, and anew before the first label, when the proposals are known.
    What a model costs is compared in dollars; where the price is not known, in tokens of its answers.
    """

    def __init__(self, model: VLM, estimate: Estimate, times: float) -> None:
        self.name = model.name
        self._model = model
        self._estimate = estimate
        self._times = times
        self._lock = threading.Lock()
        self._stages: set[bool] = set()
        self._expected: Expected | None = None
        self._before = Expected(0, 0, 0.0)
        self._spent = Expected(0, 0, 0.0)

    def answer(self, request: Request) -> Answer:
        """The model's answer. Raises ``BeyondEstimateError`` instead of asking further beyond the estimate."""
        with self._lock:
            proposing = request.purpose in (Purpose.PROPOSE, Purpose.DEFINE)
            if proposing not in self._stages:
                self._stages.add(proposing)
                self._expected, self._before = self._estimate(), self._spent
            self._check()
            spent = self._spent
            self._spent = Expected(spent.questions + 1, spent.output_tokens, spent.dollars)
        answer = self._model.answer(request)
        with self._lock:
            spent, took = self._spent, answer.spent
            dollars = None if spent.dollars is None or took.dollars is None else spent.dollars + took.dollars
            self._spent = Expected(spent.questions, spent.output_tokens + took.output_tokens, dollars)
        return answer

    def stop(self) -> None:
        """End all waiting: the run is over."""
        if isinstance(self._model, Stoppable):
            self._model.stop()

    def _check(self) -> None:
        expected, before, spent = self._expected, self._before, self._spent
        if expected is None:
            return
        compared: list[tuple[str, float, float]] = [
            ("questions", spent.questions - before.questions, expected.questions)
        ]
        if spent.dollars is not None and before.dollars is not None and expected.dollars is not None:
            compared.append(("dollars", spent.dollars - before.dollars, expected.dollars))
        else:
            compared.append(("tokens of answers", spent.output_tokens - before.output_tokens, expected.output_tokens))
        for what, used, wanted in compared:
            if used > self._times * wanted:
                raise BeyondEstimateError(
                    f"{self.name}: {used:.4g} {what} were spent where a dry run says {wanted:.4g}, so the run was "
                    f"stopped. Answers so far are stored. Look at some with 'pix2pred answers list'; for a model that "
                    "thinks, say so with 'flow: {thinking: TOKENS}' so that the dry run counts it; to go on from here "
                    f"all the same, set 'flow: {{beyond_estimate: {2 * self._times:g}}}' and run the same command again"
                )
