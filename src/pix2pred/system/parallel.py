"""Work in parallel through joblib: the same results, in the same order, whatever the engine and number of workers.

``loky`` is joblib's own engine (processes of this machine). ``dask`` and ``ray`` can reach further machines: they use
the cluster named by ``DASK_SCHEDULER_ADDRESS`` or ``RAY_ADDRESS``, or else start workers on this machine.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, TypeVar

from joblib import Parallel, delayed, parallel_config

from pix2pred.system.errors import Pix2predError
from pix2pred.system.extras import install_command

Item = TypeVar("Item")
Result = TypeVar("Result")


class Backend(StrEnum):
    """The engines that joblib can drive."""

    LOKY = "loky"
    DASK = "dask"
    RAY = "ray"


class BackendError(Pix2predError, RuntimeError):
    """An engine that cannot be used; the message says what to install or to change."""


@dataclass(frozen=True, slots=True)
class Workers:
    """How many workers, and which engine runs them. One worker of ``loky`` is this process itself."""

    jobs: int = 1
    backend: Backend = Backend.LOKY

    def __post_init__(self) -> None:
        if self.jobs < 1:
            raise BackendError(f"--jobs {self.jobs}: at least one worker is needed")

    def map(self, function: Callable[[Item], Result], items: Sequence[Item]) -> Iterator[Result]:
        """``function`` of every item, in the order of ``items``; each result as soon as those before it are there.

        ``function`` and ``items`` must survive pickling unless one ``loky`` worker does it all. Raises
        ``BackendError`` for an engine that is not installed, and whatever ``function`` raises.
        """
        with self.ready() as apply:
            yield from apply(function, items)

    @contextmanager
    def ready(self) -> Iterator[Callable[[Callable[..., Any], Sequence[Any]], Iterable[Any]]]:
        """``map`` for many calls: the engine starts once and stops at the end."""
        if self.backend == Backend.LOKY and self.jobs == 1:
            yield map
            return
        with ExitStack() as stack:
            engine = {Backend.LOKY: _loky, Backend.DASK: _dask, Backend.RAY: _ray}[self.backend]
            stack.enter_context(parallel_config(**engine(self.jobs, stack)))
            as_they_come = self.backend != Backend.RAY  # which gives results only when all are there
            parallel = Parallel(n_jobs=self.jobs, batch_size=1, return_as="generator" if as_they_come else "list")
            work = stack.enter_context(parallel)
            yield lambda function, items: work(delayed(_InThreads(function))(item) for item in items)


@dataclass(frozen=True, slots=True)
class _InThreads:
    """A function whose own parallel work stays in its worker, instead of being sent through the engine again."""

    function: Callable[[Any], Any]

    def __call__(self, item: Any) -> Any:
        with parallel_config(backend="threading"):
            return self.function(item)


def _loky(jobs: int, stack: ExitStack) -> dict[str, Any]:
    return {"backend": "loky", "inner_max_num_threads": 1}


def _dask(jobs: int, stack: ExitStack) -> dict[str, Any]:
    try:
        import dask
        from distributed import Client
    except ImportError as error:
        raise BackendError(f"--backend dask needs the extra 'dask': {install_command('dask')}") from error
    address = dask.config.get("scheduler-address", None)
    local = {"n_workers": jobs, "threads_per_worker": 1, "dashboard_address": None}
    stack.enter_context(Client(address) if address else Client(**local))
    return {"backend": "dask"}


def _ray(jobs: int, stack: ExitStack) -> dict[str, Any]:
    try:
        import ray
        from ray.util.joblib import register_ray
    except ImportError as error:
        raise BackendError(f"--backend ray needs the extra 'ray': {install_command('ray')}") from error
    if not ray.is_initialized():
        here = {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}  # workers of this machine import what we can
        local: dict[str, Any] = {"num_cpus": jobs, "include_dashboard": False, "runtime_env": {"env_vars": here}}
        ray.init(log_to_driver=False, **({} if os.environ.get("RAY_ADDRESS") else local))
        stack.callback(ray.shutdown)
    register_ray()
    return {"backend": "ray"}
