"""Greedy search that evaluates many states at once."""
