"""Places and frames, and what a robot stands in."""
