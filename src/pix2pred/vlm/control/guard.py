"""Spending far beyond what a dry run says is stopped before it happens: something is wrong that no single answer shows.

What is compared is the dry run of the moment at which the run began, the one a person can have seen. Questions under
way are taken for as dear as their budgets allow; where all of them together could pass the limit, they go one by one.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from math import inf

from pix2pred.system.errors import StoppedError
from pix2pred.vlm.request import VLM, Answer, NoAnswerError, Purpose, Request, Spent, VLMError


@dataclass(frozen=True, slots=True)
class Expected:
    """Questions, tokens of their answers, and dollars where the price is known."""

    questions: int
    output_tokens: int
    dollars: float | None

    @classmethod
    def of(cls, spent: Spent) -> Expected:
        """What one question took."""
        return cls(1, spent.output_tokens, spent.dollars)

    def plus(self, other: Expected) -> Expected:
        """Both together; the price is unknown when one of them is."""
        dollars = None if self.dollars is None or other.dollars is None else self.dollars + other.dollars
        return Expected(self.questions + other.questions, self.output_tokens + other.output_tokens, dollars)

    def dearer(self, other: Expected) -> Expected:
        """The larger of both, number by number."""
        dollars = None if self.dollars is None or other.dollars is None else max(self.dollars, other.dollars)
        return Expected(1, max(self.output_tokens, other.output_tokens), dollars)


Estimate = Callable[[], Expected | None]
"""A dry run of what is not stored yet; ``None`` when none can be made."""

Forecast = Callable[[Request], Spent]
"""The most that a question can take with the budget it would be asked with now."""

NOTHING = Expected(0, 0, 0.0)
_NEAR = 2 / 3
"""Share of the limit beyond which a question is taken for as dear as its budget allows, not as the dearest so far."""


class BeyondEstimateError(StoppedError, VLMError):
    """More would be spent than the dry run allows for. What was answered is stored."""


class GuardVLM:
    """Ends the run before it spends more than ``times`` what ``estimate`` said when it began.

    Compared are questions, and dollars; where the price is not known, tokens of answers. The first question is always
    asked. When the proposals are known, a second dry run shows whether the labels they ask for stay within the limit.
    """

    def __init__(self, model: VLM, estimate: Estimate, times: float, forecast: Forecast) -> None:
        self.name = model.name
        self._model = model
        self._estimate = estimate
        self._times = times
        self._forecast = forecast
        self._turn = threading.Condition()
        self._expected: Expected | None = None
        self._begun = False
        self._proposed = False
        self._spent = NOTHING
        self._dearest = NOTHING
        self._known_budget = 0
        self._under_way: list[Expected] = []
        self._stopped = False

    def answer(self, request: Request) -> Answer:
        """The model's answer. Raises ``BeyondEstimateError`` instead of asking what could pass the limit."""
        with self._turn:
            self._look_ahead(request)
            most = NOTHING

            def may_go() -> bool:
                nonlocal most  # looked up each time: another answer may have raised the budget for thinking
                most = Expected.of(self._forecast(request))
                return self._stopped or not self._under_way or self._all_fit(most)

            self._turn.wait_for(may_go)
            if self._stopped:
                raise NoAnswerError("the run was ended while this question waited for its turn")
            if not self._under_way:
                self._check(most)
            self._under_way.append(most)
        took = NOTHING
        try:
            answer = self._model.answer(request)
            took = Expected.of(answer.spent)
        except VLMError as error:
            took = Expected.of(error.spent) if error.spent is not None else NOTHING
            raise
        finally:
            with self._turn:
                self._under_way.remove(most)
                if took.questions:
                    self._spent = self._spent.plus(took)
                    self._dearest = self._dearest.dearer(took)
                    self._known_budget = max(self._known_budget, most.output_tokens)
                self._turn.notify_all()
        return answer

    def stop(self) -> None:
        """End all waiting: the run is over."""
        with self._turn:
            self._stopped = True
            self._turn.notify_all()

    def _look_ahead(self, request: Request) -> None:
        """Make the dry run before the first question, and another before the first label."""
        proposing = request.purpose in (Purpose.PROPOSE, Purpose.DEFINE)
        if not self._begun:
            self._begun, self._proposed = True, not proposing
            self._expected = self._estimate()
        elif not proposing and not self._proposed:
            self._proposed = True
            again = self._estimate()
            if again is not None and self._share(self._spent.plus(again)) > 1:
                raise self._stop(self._spent.plus(again), "would be spent, now that the proposals are known")

    def _all_fit(self, most: Expected) -> bool:
        together = self._spent.plus(most)
        for under_way in self._under_way:
            together = together.plus(under_way)
        return self._share(together) <= 1

    def _check(self, most: Expected) -> None:
        """Raise unless the question, the only one under way, will stay within the limit."""
        if not self._spent.questions:
            return
        unknown = most.output_tokens > self._known_budget
        reckoned = most if unknown or self._share(self._spent) > _NEAR else self._dearest
        if self._share(self._spent.plus(reckoned)) > 1:
            raise self._stop(self._spent, "are spent, and the next question could pass the limit")

    def _share(self, amount: Expected) -> float:
        """The largest share of its limit that a number in ``amount`` takes; above 1 it is passed."""
        return max((used / limit if limit else inf if used else 0.0 for _, used, limit in self._against(amount)),
                   default=0.0)  # fmt: skip

    def _against(self, amount: Expected) -> list[tuple[str, float, float]]:
        """What is compared: what it is, how much of it ``amount`` holds, and how much there may be."""
        expected = self._expected
        if expected is None:
            return []
        rows: list[tuple[str, float, float]] = [("questions", amount.questions, expected.questions)]
        if amount.dollars is not None and expected.dollars is not None:
            rows.append(("dollars", amount.dollars, expected.dollars))
        else:
            rows.append(("tokens of answers", amount.output_tokens, expected.output_tokens))
        return [(what, used, self._times * said) for what, used, said in rows]

    def _stop(self, amount: Expected, how: str) -> BeyondEstimateError:
        what, used, limit = max(self._against(amount), key=lambda row: row[1] / row[2] if row[2] else inf)
        return BeyondEstimateError(
            f"{self.name}: {_number(used)} {what} {how}; a dry run said {_number(limit / self._times)}, and beyond "
            f"{self._times:g} times that a run stops. Answers so far are stored, and the same command goes on from "
            "them; see with --dry-run what is left. For a model that thinks, say how much with 'flow: {thinking: "
            "TOKENS}', and the dry run counts it; or allow more with "
            f"'flow: {{beyond_estimate: {2 * self._times:g}}}'"
        )


def _number(amount: float) -> str:
    return f"{amount:,.0f}" if amount >= 100 else f"{amount:.3g}"
