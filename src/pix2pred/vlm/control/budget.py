"""A limit on what may be spent, checked before every request."""

from __future__ import annotations

import threading

from pix2pred.system.errors import StoppedError
from pix2pred.vlm.request import VLM, Answer, Request, VLMError


class BudgetError(StoppedError, VLMError):
    """The budget is used up. What was answered is stored."""


class BudgetVLM:
    """Lets at most ``max_requests`` requests out, and none that could bring the cost above ``max_cost`` dollars.

    Each request under way is taken to cost as much as the dearest one so far. Requests that fail count as requests.
    """

    def __init__(self, model: VLM, max_requests: int | None = None, max_cost: float | None = None) -> None:
        self.name = model.name
        self._model = model
        self._max_requests = max_requests
        self._max_cost = max_cost
        self._requests = 0
        self._under_way = 0
        self._spent = 0.0
        self._dearest = 0.0
        self._unpriced = False
        self._lock = threading.Lock()

    def answer(self, request: Request) -> Answer:
        """The model's answer. Raises ``BudgetError`` instead of asking beyond the budget."""
        with self._lock:
            self._check()
            self._requests += 1
            self._under_way += 1
        spent = None
        try:
            answer = self._model.answer(request)
            spent = answer.spent
        except VLMError as error:
            spent = error.spent
            raise
        finally:
            with self._lock:
                self._under_way -= 1
                if spent is not None:
                    self._unpriced |= spent.dollars is None
                    self._spent += spent.dollars or 0.0
                    self._dearest = max(self._dearest, spent.dollars or 0.0)
        return answer

    def _check(self) -> None:
        again = "answers so far are stored; the same command with a larger limit goes on from there"
        if self._max_requests is not None and self._requests >= self._max_requests:
            raise BudgetError(f"the {self._max_requests} requests of --max-requests are used up; {again}")
        if self._max_cost is not None and self._unpriced:
            raise BudgetError(
                f"{self.name}: the price of this model is not known, so --max-cost cannot be kept; use --max-requests"
            )
        if self._max_cost is not None and self._spent + (self._under_way + 1) * self._dearest > self._max_cost:
            raise BudgetError(
                f"${self._spent:.4f} are spent; another request could exceed the ${self._max_cost:g} of --max-cost; "
                + again
            )
