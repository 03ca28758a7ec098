"""Models that err on purpose, for tests and studies alone."""
