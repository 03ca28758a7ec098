"""A belief about the world: what is probably true, given labels that are sometimes wrong."""
