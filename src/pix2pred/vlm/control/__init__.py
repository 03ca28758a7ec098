"""What a run may ask, spend and wait for, and what it has spent."""
