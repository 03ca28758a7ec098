"""Pictures of the burger kitchen."""
