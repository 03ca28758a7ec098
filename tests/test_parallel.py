"""The same results in the same order, whatever the engine and the number of workers."""

from __future__ import annotations

import builtins
import os
import threading
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from joblib import Parallel, delayed

from extras import need
from pix2pred.system.parallel import Backend, BackendError, Workers

ENGINES = [
    pytest.param(Workers(1), id="one"),
    pytest.param(Workers(2), id="loky"),
    pytest.param(Workers(2, Backend.DASK), id="dask", marks=need("dask", "distributed", extra="dask")),
    pytest.param(Workers(2, Backend.RAY), id="ray", marks=need("ray", extra="ray")),
]


def draw(seed: int) -> bytes:
    """Slow for early items, so that workers finish in another order than they begin."""
    time.sleep(0.02 if seed == 0 else 0)
    return np.random.default_rng(seed).random(4).tobytes()


def fail(number: int) -> int:
    if number == 2:
        raise ValueError(f"item {number} cannot be worked on")
    return number


@pytest.mark.parametrize("workers", ENGINES)
def test_every_engine_gives_the_same_bytes_in_the_same_order(workers: Workers) -> None:
    assert list(workers.map(draw, range(7))) == [draw(seed) for seed in range(7)]


def nested(item: int) -> list[int]:
    """Work that is itself parallel, on something that cannot be sent anywhere."""
    lock = threading.Lock()

    def one(x: int) -> int:
        with lock:
            return x + item

    return list(Parallel(n_jobs=2, prefer="threads")(delayed(one)(x) for x in range(3)))


@pytest.mark.parametrize("workers", ENGINES)
def test_parallel_work_inside_a_worker_stays_there(workers: Workers) -> None:
    assert list(workers.map(nested, range(3))) == [[x + item for x in range(3)] for item in range(3)]


@pytest.mark.parametrize("workers", ENGINES)
def test_an_error_reaches_the_caller(workers: Workers) -> None:
    with pytest.raises(ValueError, match="item 2 cannot be worked on"):
        list(workers.map(fail, range(4)))


def test_results_arrive_while_later_items_are_still_to_be_done() -> None:
    begun: list[int] = []

    def note(item: int) -> int:
        begun.append(item)
        return item

    results: Iterator[int] = Workers(1).map(note, range(3))
    assert next(results) == 0 and begun == [0]


def test_two_workers_are_other_processes() -> None:
    assert os.getpid() not in set(Workers(2).map(_process, range(2)))


def _process(_: int) -> int:
    return os.getpid()


@pytest.mark.parametrize(("backend", "module"), [(Backend.DASK, "dask"), (Backend.RAY, "ray")])
def test_an_engine_that_is_not_installed_names_its_extra(
    backend: Backend, module: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = builtins.__import__

    def without(name: str, *args: Any, **options: Any) -> Any:
        if name.split(".")[0] == module:
            raise ImportError(name)
        return real(name, *args, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(BackendError, match=rf"pip install .*\[{module}\]"):
        list(Workers(2, backend).map(draw, range(2)))


def test_no_worker_at_all_is_refused() -> None:
    with pytest.raises(BackendError, match="at least one worker"):
        Workers(0)
