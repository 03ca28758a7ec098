"""Work inside work inside work: all of it at once as far as places go, results in order, errors the first."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable

import pytest

from pix2pred.vlm import Together

WAITING = 30.0
"""Seconds after which a test that waits for others has failed."""


class Meeting:
    """Lets those who come pass only when as many are there as are awaited; remembers the most at once."""

    def __init__(self, awaited: int) -> None:
        self.most = 0
        self._awaited = awaited
        self._here = 0
        self._changed = threading.Condition()

    def come(self) -> None:
        with self._changed:
            self._here += 1
            self.most = max(self.most, self._here)
            self._changed.notify_all()
            assert self._changed.wait_for(lambda: self.most >= self._awaited, WAITING), "others were held back"
            self._here -= 1


def nested(together: Together, ask: Callable[[str], str]) -> list[str]:
    """Two demonstrations of three batches of five votes."""

    def batch(name: str) -> str:
        return " ".join(together.map(lambda vote: ask(f"{name}{vote}"), range(5)))

    def demo(name: str) -> str:
        return " | ".join(together.map(lambda number: batch(f"{name}{number}"), range(3)))

    return list(together.map(demo, ("a", "b")))


def test_all_levels_ask_at_once_when_there_are_places() -> None:
    meeting = Meeting(30)

    def ask(name: str) -> str:
        meeting.come()
        return name

    said = nested(Together(30), ask)
    assert meeting.most == 30
    assert said[0].startswith("a00 a01 a02 a03 a04 | a10") and said[1].endswith("b23 b24")


@pytest.mark.parametrize("places", [1, 2, 7])
def test_places_bound_all_levels_together_and_change_no_result(places: int) -> None:
    meeting = Meeting(places)

    def ask(name: str) -> str:
        meeting.come()
        return name

    assert nested(Together(places), ask) == nested(Together(100), lambda name: name)
    assert meeting.most == places, "neither fewer nor more"


def test_what_was_begun_is_finished_before_more_is_begun() -> None:
    asked: list[str] = []

    def ask(name: str) -> str:
        asked.append(name)
        return name

    nested(Together(1), ask)
    assert asked == [f"{d}{b}{v}" for d in "ab" for b in range(3) for v in range(5)]


def test_the_first_error_in_order_is_raised_and_nothing_more_begins() -> None:
    begun: list[int] = []
    second_failed = threading.Event()

    def work(number: int) -> int:
        begun.append(number)
        if number == 0:
            assert second_failed.wait(WAITING)
            raise ValueError("first")
        second_failed.set()
        raise KeyError("second")

    together = Together(2)
    with pytest.raises(ValueError, match="first"):
        list(together.map(work, range(50)))
    assert sorted(begun) == [0, 1]
    assert list(together.map(abs, (-1, -2, -3))) == [1, 2, 3], "its places are free again"


def test_results_come_before_later_work_has_ended() -> None:
    go_on = threading.Event()

    def work(number: int) -> int:
        assert number == 0 or go_on.wait(WAITING)
        return number

    results = Together(2).map(work, range(3))
    assert next(results) == 0
    go_on.set()
    assert list(results) == [1, 2]


def test_whoever_waits_for_a_place_hears_of_one_that_is_given_up() -> None:
    """Threads are switched as often as can be: a missed call would leave all of them waiting for ever."""

    def ask_often() -> None:
        for number in range(60):
            nested(Together(1 + number % 4), lambda name: name)

    usual = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        asking = threading.Thread(target=ask_often, daemon=True)
        asking.start()
        asking.join(WAITING)
    finally:
        sys.setswitchinterval(usual)
    assert not asking.is_alive()
