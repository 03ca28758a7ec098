"""Locks between processes: a file that one process at a time holds, until it lets go or ends."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from pix2pred.system.errors import Pix2predError
from pix2pred.system.files import refuse_irregular

_FOR_EVER = -1


class LockedError(Pix2predError, RuntimeError):
    """Another process holds the lock."""


@contextmanager
def held(path: Path, *, wait: bool) -> Iterator[None]:
    """Hold the lock file at ``path``, which is made when it is missing and whose content is never touched.

    Raises ``LockedError`` when another process holds it, unless it is to ``wait``; and ``OSError`` when it cannot be
    opened or is a link, a pipe or anything else that is no regular file.
    """
    refuse_irregular(path)
    lock = FileLock(path, timeout=_FOR_EVER if wait else 0, thread_local=False, mode=0o600)
    try:
        lock.acquire()
    except Timeout as error:
        raise LockedError(f"{path}: another process holds this lock") from error
    except OSError as error:
        raise OSError(error.errno, error.strerror or os.strerror(error.errno or 0), str(path)) from error
    try:
        yield
    finally:
        lock.release()
