"""The services of a simulated robot, on the servicers that the vendor's interface generates."""
