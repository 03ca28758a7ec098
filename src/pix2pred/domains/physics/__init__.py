"""What the MuJoCo domains share: the library, building scenes, and cameras that know where objects are in pictures."""

from pix2pred.domains.physics.camera import Camera, Renderer, boxes_of
from pix2pred.domains.physics.library import OpenGLMissingError, check_drawing, mujoco_library
from pix2pred.domains.physics.maker import Maker

__all__ = ["Camera", "Maker", "OpenGLMissingError", "Renderer", "boxes_of", "check_drawing", "mujoco_library"]
