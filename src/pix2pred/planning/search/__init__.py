"""Searches over ground tasks, one a file."""
