"""Ctrl-C between calls to the robot, not in their midst: the library below breaks its memory when it is torn out."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def heard_later() -> Iterator[None]:
    """Ctrl-C within is heard at the end. Calls have deadlines, so that the end comes soon."""
    if threading.current_thread() is not threading.main_thread():  # other threads hear none
        yield
        return
    heard = []
    before = signal.signal(signal.SIGINT, lambda number, frame: heard.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler if before is None else before)
        if heard:
            signal.raise_signal(signal.SIGINT)
