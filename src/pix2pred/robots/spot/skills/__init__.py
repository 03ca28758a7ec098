"""Skills as programs over the vendor's commands, a room for each kind of task."""
