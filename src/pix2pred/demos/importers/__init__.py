"""Data of other origins as demonstrations: photos and frames in folders, videos, LeRobot datasets."""

from pix2pred.demos.files.sidecar import read_sidecar
from pix2pred.demos.importers.bits import traces_of_bits
from pix2pred.demos.importers.frames import drafts_of_frames
from pix2pred.demos.importers.label_file import with_labels
from pix2pred.demos.importers.lerobot import drafts_of_lerobot
from pix2pred.demos.importers.video import drafts_of_videos

__all__ = ["drafts_of_frames", "drafts_of_lerobot", "drafts_of_videos", "read_sidecar", "traces_of_bits", "with_labels"]
