"""The coffee corner in MuJoCo: its model, motion and camera."""
