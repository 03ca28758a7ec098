"""Planners of others, run out of process."""
