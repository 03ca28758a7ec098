"""The frugal protocol: words with definitions, and all states of a demonstration in one question."""
