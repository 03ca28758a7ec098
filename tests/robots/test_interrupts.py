from __future__ import annotations

import signal
import threading

import pytest

from pix2pred.robots.spot.interrupts import heard_later


def test_ctrl_c_is_heard_at_the_end_of_the_outermost_call() -> None:
    done = []
    with pytest.raises(KeyboardInterrupt), heard_later():
        with heard_later():
            signal.raise_signal(signal.SIGINT)
            done.append("inner")
        done.append("outer")
    assert done == ["inner", "outer"] and signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_what_goes_wrong_within_gives_way_to_ctrl_c() -> None:
    with pytest.raises(KeyboardInterrupt), heard_later():
        signal.raise_signal(signal.SIGINT)
        raise ValueError
    with pytest.raises(ValueError, match="no Ctrl-C"), heard_later():
        raise ValueError("no Ctrl-C")


def test_other_threads_hear_none() -> None:
    done = []

    def work() -> None:
        with heard_later():
            done.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert done == [signal.default_int_handler]
