"""The root of every error of ours that a user can cause, meet, or put right."""

from __future__ import annotations


class Pix2predError(Exception):
    """Catch this one to catch them all. The message says what was wrong, where, and what to do about it."""


class StoppedError(Pix2predError):
    """A job that was asked for rightly and ended early: what it may spend is spent, or going on is no use."""
