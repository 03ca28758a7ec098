"""From PDDL to a task on bits."""
