"""Looking for garbage less often, and as often as before afterwards."""

from __future__ import annotations

import gc
import threading

import pytest

from pix2pred.system.garbage import seldom_collected


def test_thresholds_come_back_whatever_happens() -> None:
    before = gc.get_threshold()
    with pytest.raises(KeyError), seldom_collected():
        inside = gc.get_threshold()
        with seldom_collected():
            assert gc.get_threshold() == inside
        assert gc.get_threshold() == inside
        raise KeyError
    assert inside[0] > before[0] and gc.get_threshold() == before


def test_the_last_of_several_threads_brings_them_back() -> None:
    before = gc.get_threshold()
    entered, leave = threading.Event(), threading.Event()

    @seldom_collected()
    def other() -> None:
        entered.set()
        leave.wait()

    thread = threading.Thread(target=other)
    with seldom_collected():
        thread.start()
        entered.wait()
    assert gc.get_threshold() != before
    leave.set()
    thread.join()
    assert gc.get_threshold() == before
