"""Operators from labelled transitions."""
