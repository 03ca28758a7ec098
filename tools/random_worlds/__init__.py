"""Worlds of any arrangement, for training and judging the offline readers: a module for every bundled domain."""
