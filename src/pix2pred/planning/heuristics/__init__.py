"""Estimates of the distance to a goal, one a file."""
