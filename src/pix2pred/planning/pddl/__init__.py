"""PDDL read and written."""
