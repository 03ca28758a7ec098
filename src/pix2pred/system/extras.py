"""Optional packages: imported where they are used, and asked for by name when they are absent."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from pix2pred.system.errors import Pix2predError


class MissingExtraError(Pix2predError, ImportError):
    """Something is not installed; the message says which command installs it."""


def optional(module: str, extra: str) -> Any:
    """The module called ``module``. Raises ``MissingExtraError`` naming the extra that brings it."""
    try:
        return import_module(module)
    except ImportError as error:
        raise MissingExtraError(
            f"{module.partition('.')[0]} is not installed ({error}); install it with: pip install 'pix2pred[{extra}]'"
        ) from error
