"""What happens to a picture before a model sees it: crop, size, set-of-marks, heading."""

from pix2pred.images.crops import skill_crop
from pix2pred.images.draw import draw_view, encode_png
from pix2pred.images.likeness import nearly_same
from pix2pred.images.shown import ShownPictures

__all__ = ["ShownPictures", "draw_view", "encode_png", "nearly_same", "skill_crop"]
