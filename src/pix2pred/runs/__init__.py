"""The folder of a run, and learning, solving and planning into one."""
