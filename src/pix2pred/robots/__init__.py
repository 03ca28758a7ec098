"""Robots that execute plans: what they offer, one that is simulated without a network, and a Spot (method 10.6)."""
