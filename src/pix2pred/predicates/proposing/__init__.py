"""Candidate predicates from a model's proposals."""
