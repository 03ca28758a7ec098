"""A model behind a store: gaps, retries, what ends a run, one question from many threads."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest

from pix2pred.vlm import (
    Answer,
    AnswerStore,
    Finish,
    NoAnswerError,
    Purpose,
    Request,
    Spent,
    StoredVLM,
    StoreMode,
    Token,
    VLMError,
)

REQUEST = Request(Purpose.LABEL, ("Is it?",), 10, logprobs=True)
RICH = Answer("True", tokens=(Token("True", (("True", -0.1), ("False", -2.5))),), spent=Spent(12, 3, 0.25))


@dataclass
class Model:
    say: Answer | VLMError
    name: str = "m"
    asked: list[Request] = field(default_factory=list)

    def answer(self, request: Request) -> Answer:
        self.asked.append(request)
        if isinstance(self.say, VLMError):
            raise self.say
        return self.say


def test_tokens_costs_and_endings_come_back(tmp_path: Path) -> None:
    store = AnswerStore(tmp_path)
    StoredVLM(Model(RICH), store).answer(REQUEST)
    assert store.get(REQUEST.key("m")) == replace(RICH, stored=True)
    for finish in Finish:
        store.put(replace(REQUEST, sample=1), "m", Answer("x", finish=finish))
        assert store.get(replace(REQUEST, sample=1).key("m")) == Answer("x", stored=True, finish=finish)


def test_a_question_without_an_answer_is_asked_again_but_replays_as_a_gap(tmp_path: Path) -> None:
    store = AnswerStore(tmp_path)
    with pytest.raises(NoAnswerError, match="HTTP 500"):
        StoredVLM(Model(NoAnswerError("HTTP 500, 9 times")), store).answer(REQUEST)
    with pytest.raises(NoAnswerError, match="HTTP 500, 9 times"):
        StoredVLM(Model(RICH), store, StoreMode.REPLAY).answer(REQUEST)
    assert StoredVLM(Model(RICH), store).answer(REQUEST).text == "True"
    assert StoredVLM(Model(RICH), store, StoreMode.REPLAY).answer(REQUEST).text == "True"


@pytest.mark.parametrize("finish", [Finish.REFUSED, Finish.CUT_SHORT])
def test_retry_asks_what_was_refused_or_cut_short_and_nothing_else(tmp_path: Path, finish: Finish) -> None:
    store = AnswerStore(tmp_path)
    store.put(REQUEST, "m", Answer("Sorry", finish=finish))
    whole = replace(REQUEST, sample=1)
    store.put(whole, "m", Answer("False"))
    model = Model(RICH)
    assert StoredVLM(model, store).answer(REQUEST).text == "Sorry"
    retry = StoredVLM(model, store, StoreMode.RETRY)
    assert [retry.answer(r).text for r in (REQUEST, whole)] == ["True", "False"]
    assert model.asked == [REQUEST]


def test_one_question_from_many_threads_goes_out_once(tmp_path: Path) -> None:
    class Slow(Model):
        def answer(self, request: Request) -> Answer:
            time.sleep(0.05)
            return super().answer(request)

    model = Slow(RICH)
    vlm = StoredVLM(model, AnswerStore(tmp_path))
    threads = [threading.Thread(target=vlm.answer, args=(REQUEST,)) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(model.asked) == 1


def test_the_error_that_ends_a_run_waits_for_answers_under_way_and_lets_no_more_out(tmp_path: Path) -> None:
    started, stopped = threading.Event(), threading.Event()

    class Ending(Model):
        def answer(self, request: Request) -> Answer:
            self.asked.append(request)
            if request.sample == 0:
                started.wait(60)
                raise VLMError("out of credit")
            started.set()
            time.sleep(0.3)
            return Answer("late but paid for")

        def stop(self) -> None:
            stopped.set()

    model, store = Ending(RICH), AnswerStore(tmp_path)
    vlm = StoredVLM(model, store)
    other = threading.Thread(target=vlm.answer, args=(replace(REQUEST, sample=1),))
    other.start()
    with pytest.raises(VLMError, match="out of credit"):
        vlm.answer(REQUEST)
    assert store.get(replace(REQUEST, sample=1).key("m")) is not None, "stored before the error came out"
    assert stopped.is_set()
    with pytest.raises(VLMError, match="out of credit"):
        vlm.answer(replace(REQUEST, sample=2))
    assert len(model.asked) == 2
    other.join()
