"""Distilling a run: from its labels and pictures to a reader's folder."""
