"""Pauses, places, budgets, the circuit breaker: with a clock and a model that tests control."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import pytest

from pix2pred.vlm import Answer, Finish, FlowSettings, NoAnswerError, Purpose, Request, Review, Spent, VLMError
from pix2pred.vlm.control.breaker import BreakerVLM, UselessModelError
from pix2pred.vlm.control.budget import BudgetError, BudgetVLM
from pix2pred.vlm.control.flow import FlowVLM, TransientError
from pix2pred.vlm.control.rate_limits import pause_after, retry_after, seconds

REQUEST = Request(Purpose.LABEL, ("Is it?",), 10)


@dataclass
class Script:
    """Gives answers and errors in order, then "yes"."""

    script: Sequence[Answer | Exception] = ()
    name: str = "script"
    asked: list[Request] = field(default_factory=list)

    def answer(self, request: Request) -> Answer:
        self.asked.append(request)
        said = self.script[len(self.asked) - 1] if len(self.asked) <= len(self.script) else Answer("yes")
        if isinstance(said, Exception):
            raise said
        return said


class Paused(FlowVLM):
    """Notes pauses in place of pausing; the clock moves on by them."""

    def __init__(self, model: Script, **settings: float) -> None:
        self.pauses: list[float] = []
        self.now = 0.0
        super().__init__(model, FlowSettings(**settings), clock=lambda: self.now, jitter=lambda: 0.5)

    def _pause(self, seconds: float) -> None:
        self.pauses.append(seconds)
        self.now += seconds


def test_pauses_double_up_to_the_cap_with_jitter() -> None:
    flow = Paused(Script([TransientError("HTTP 500")] * 7), first_pause=1, longest_pause=20)
    assert flow.answer(REQUEST).text == "yes"
    assert flow.pauses == [0.5, 1, 2, 4, 8, 10, 10]


def test_a_server_that_says_when_is_obeyed_and_others_wait_too() -> None:
    flow = Paused(Script([TransientError("HTTP 429", 7.0)]), first_pause=1)
    flow.answer(REQUEST)
    assert flow.pauses == [7.0]
    flow.hold(3.0)
    flow.answer(REQUEST)
    assert flow.pauses == [7.0, 3.0]


def test_a_question_is_given_up_after_all_tries_and_others_go_on() -> None:
    model = Script([TransientError("HTTP 502: bad")] * 3)
    flow = Paused(model, tries=3)
    with pytest.raises(NoAnswerError, match="HTTP 502: bad, 3 times"):
        flow.answer(REQUEST)
    assert len(model.asked) == 3 and len(flow.pauses) == 2
    assert flow.answer(REQUEST).text == "yes"


def test_an_absent_server_is_not_waited_for_unless_it_was_there_before() -> None:
    absent = TransientError("nothing can be reached", connected=False)
    model = Script([absent] * 20)
    with pytest.raises(VLMError, match="is the address right") as caught:
        Paused(model).answer(REQUEST)
    assert not isinstance(caught.value, NoAnswerError) and len(model.asked) == 4
    model = Script([Answer("here"), *[absent] * 20])
    flow = Paused(model)
    flow.answer(REQUEST)
    with pytest.raises(NoAnswerError):
        flow.answer(REQUEST)


@pytest.mark.parametrize("error", [VLMError("no key"), NoAnswerError("HTTP 400: too long")])
def test_what_will_not_pass_is_not_repeated(error: VLMError) -> None:
    model = Script([error])
    with pytest.raises(type(error), match=str(error)):
        Paused(model).answer(REQUEST)
    assert len(model.asked) == 1


def test_no_more_requests_than_places_are_under_way() -> None:
    gate, under_way, most, lock = threading.Event(), [0], [0], threading.Lock()

    class Slow(Script):
        def answer(self, request: Request) -> Answer:
            with lock:
                under_way[0] += 1
                most[0] = max(most[0], under_way[0])
            gate.wait(60)
            with lock:
                under_way[0] -= 1
            return Answer("yes")

    flow = FlowVLM(Slow(), FlowSettings(concurrent=3))
    threads = [threading.Thread(target=flow.answer, args=(REQUEST,)) for _ in range(9)]
    for thread in threads:
        thread.start()
    while most[0] < 3:
        pass
    gate.set()
    for thread in threads:
        thread.join()
    assert most[0] == 3


def test_stopping_ends_all_pauses() -> None:
    flow = FlowVLM(Script([TransientError("HTTP 429", 500.0)] * 9), FlowSettings())
    ended: list[Exception] = []

    def ask() -> None:
        try:
            flow.answer(REQUEST)
        except VLMError as error:
            ended.append(error)

    thread = threading.Thread(target=ask)
    thread.start()
    flow.stop()
    thread.join(60)
    assert not thread.is_alive() and isinstance(ended[0], NoAnswerError)


HEADERS = [
    ({}, 0.0),
    ({"x-ratelimit-remaining-requests": "3", "x-ratelimit-reset-requests": "9s"}, 0.0),
    ({"x-ratelimit-remaining-requests": "0", "x-ratelimit-reset-requests": "1m30s"}, 90.0),
    ({"x-ratelimit-remaining-tokens": "0", "x-ratelimit-reset-tokens": "20ms"}, 0.02),
    ({"anthropic-ratelimit-tokens-remaining": "0", "anthropic-ratelimit-tokens-reset": "1970-01-01T00:02:00Z"}, 20.0),
    ({"anthropic-ratelimit-requests-remaining": "0", "anthropic-ratelimit-requests-reset": "nonsense"}, 0.0),
]  # fmt: skip


@pytest.mark.parametrize(("headers", "wait"), HEADERS)
def test_allowances_in_headers(headers: dict[str, str], wait: float) -> None:
    assert pause_after(headers, 100.0) == pytest.approx(wait)


def test_waiting_times_in_headers() -> None:
    assert retry_after({"retry-after-ms": "20", "retry-after": "9"}, 0) == 0.02
    assert retry_after({"retry-after": "1.5"}, 0) == 1.5
    assert retry_after({"retry-after": "Thu, 01 Jan 1970 00:01:00 GMT"}, 10) == 50
    assert retry_after({}, 0) is None
    assert [seconds(t, 0) for t in ("6m0s", "1h", "-3", "", "x", "5 apples")] == [360, 3600, 0, 0, 0, 0]


def test_the_budget_of_requests_counts_failures() -> None:
    model = Script([TransientError("HTTP 500"), Answer("one")])
    budget = BudgetVLM(model, max_requests=3)
    with pytest.raises(TransientError):
        budget.answer(REQUEST)
    budget.answer(REQUEST)
    budget.answer(REQUEST)
    with pytest.raises(BudgetError, match="3 requests of --max-requests are used up"):
        budget.answer(REQUEST)
    assert len(model.asked) == 3


def test_the_budget_in_dollars_is_never_exceeded_by_answers_like_the_dearest() -> None:
    priced = [Answer("x", spent=Spent(1, 1, cents / 100)) for cents in (10, 30, 20, 20, 20)]
    model = Script(priced)
    budget = BudgetVLM(model, max_cost=1.0)
    asked = 0
    with pytest.raises(BudgetError, match="--max-cost"):
        while True:
            budget.answer(REQUEST)
            asked += 1
    assert asked == 4, "0.10 + 0.30 + 0.20 + 0.20, and another 0.30 would be too much"


def nonsense(text: str) -> Review | None:
    return None if "True" in text else Review("no value", usable=False)


def test_the_breaker_opens_after_useless_answers_in_a_row_and_keeps_the_last() -> None:
    said: list[Answer | Exception] = [
        Answer("True"),
        Answer("la la"),
        NoAnswerError("HTTP 500, 9 times"),
        Answer("Sorry", finish=Finish.REFUSED),
    ]
    model = Script([*said, Answer("la")])
    breaker = BreakerVLM(model, 3)
    request = replace(REQUEST, review=nonsense)
    for _ in range(2):
        breaker.answer(request)
    with pytest.raises(NoAnswerError):
        breaker.answer(request)
    assert breaker.answer(request).text == "Sorry"
    with pytest.raises(
        UselessModelError, match=r"3 answers in a row.*\(1\) 'la la' \(no value\); \(2\) no answer: HTTP 500"
    ):
        breaker.answer(request)
    assert len(model.asked) == 4


def test_an_answer_of_use_closes_the_breaker_again_and_one_cut_short_does_not_count() -> None:
    cut = Answer("Tr", finish=Finish.CUT_SHORT)
    model = Script([Answer("la"), cut, Answer("True"), Answer("la"), Answer("")])
    breaker = BreakerVLM(model, 2)
    for _ in range(5):
        breaker.answer(replace(REQUEST, review=nonsense))
    with pytest.raises(UselessModelError, match=r"\(2\) an empty answer"):
        breaker.answer(REQUEST)
