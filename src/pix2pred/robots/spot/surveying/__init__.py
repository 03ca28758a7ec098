"""What is done with a Spot before its tasks: checking it, and mapping the tags around it."""
