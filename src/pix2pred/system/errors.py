"""The root of every error of ours that a user can cause, meet, or put right."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:  # not needed by whoever only raises
    from pydantic import ValidationError
    from pydantic_core import ErrorDetails


class Pix2predError(Exception):
    """Catch this one to catch them all. The message says what was wrong, where, and what to do about it."""


class StoppedError(Pix2predError):
    """A job that was asked for rightly and ended early: what it may spend is spent, or going on is no use."""


def first_fault(error: ValidationError) -> tuple[str, ErrorDetails]:
    """What is wrong first with a document: the place in it (keys with dots between them), and all about it."""
    first = error.errors()[0]
    return ".".join(map(str, first["loc"])), first
