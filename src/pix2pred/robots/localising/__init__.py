"""Where a robot is: from tags on the walls and a map of them. Used for walking only (method 10.6)."""
