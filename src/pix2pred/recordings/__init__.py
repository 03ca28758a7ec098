"""Answers of a large vision-language model, recorded once and shipped: a demonstration without key or network."""

from pix2pred.recordings.recording import Recording, RecordingDoc, load_recording, recording_names

__all__ = ["Recording", "RecordingDoc", "load_recording", "recording_names"]
