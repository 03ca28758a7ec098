"""The store of answers, and models that answer from it."""
