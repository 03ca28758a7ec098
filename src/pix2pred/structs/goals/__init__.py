"""Goals that say what must not hold, or that can be reached in more than one way."""
