"""What the guard of spending lets through."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from pix2pred.vlm import Purpose, Request
from pix2pred.vlm.control.guard import Expected, GuardVLM
from pix2pred.vlm.request import Answer, NoAnswerError, Spent

TAKES = Spent(5, 10, None)


class Slow:
    """Answers when told to, and counts what it was asked."""

    name = "slow"

    def __init__(self) -> None:
        self.asked, self.under_way, self.answering = 0, threading.Event(), threading.Event()

    def answer(self, request: Request) -> Answer:
        self.asked += 1
        self.under_way.set()
        assert self.answering.wait(60)
        return Answer("yes", spent=TAKES)


def test_a_question_that_waits_for_its_turn_is_not_asked_when_the_run_ends() -> None:
    model, reckoned = Slow(), threading.Semaphore(0)

    def forecast(request: Request) -> Spent:
        reckoned.release()
        return TAKES

    guard = GuardVLM(model, lambda: Expected(2, 10, None), 1.0, forecast)
    first, second = (Request(Purpose.LABEL, (text,), 10) for text in ("first", "second"))
    with ThreadPoolExecutor(2) as threads:
        going = threads.submit(guard.answer, first)
        assert model.under_way.wait(60)
        assert reckoned.acquire(timeout=60)
        waiting = threads.submit(guard.answer, second)
        assert reckoned.acquire(timeout=60)  # both together would pass the limit
        guard.stop()
        with pytest.raises(NoAnswerError, match="was ended"):
            waiting.result(60)
        model.answering.set()
        assert going.result(60).text == "yes" and model.asked == 1
