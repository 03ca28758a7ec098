"""What the MuJoCo domains share: finding the library, and a camera that knows where objects are in its pictures."""

from pix2pred.domains.physics.camera import Camera, Renderer, boxes_of
from pix2pred.domains.physics.library import OpenGLMissingError, check_drawing, mujoco_library

__all__ = ["Camera", "OpenGLMissingError", "Renderer", "boxes_of", "check_drawing", "mujoco_library"]
