"""Objects by the place where they are defined, and those that other packages add through entry points."""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import entry_points
from typing import Any


def named(group: str, ours: dict[str, str]) -> dict[str, str]:
    """The names of a table, each with the place of its object, and those that other packages add to it; ours win."""
    return {e.name: e.value for e in entry_points(group=f"pix2pred.{group}")} | ours


def load(target: str) -> Any:
    """The object at ``module:attribute``."""
    module, _, attribute = target.partition(":")
    return getattr(import_module(module), attribute)
