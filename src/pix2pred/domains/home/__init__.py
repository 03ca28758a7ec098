"""The world of the home domains: rooms, things, a person's and a robot's view of them (method 10.4 to 10.6)."""
