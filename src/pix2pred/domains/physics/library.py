"""MuJoCo, imported only when a domain that needs it is used, with one clear message when it cannot draw here."""

from __future__ import annotations

import os
import sys
from typing import Any

from pix2pred.structs.extras import MissingExtraError, optional

_NEEDS = {"egl": "libegl1 libgl1", "osmesa": "libosmesa6", "glfw": "libglfw3 libgl1"}


class OpenGLMissingError(MissingExtraError):
    """MuJoCo is installed, but no OpenGL to draw with; the message names the system packages."""

    def __init__(self, backend: str, reason: object) -> None:
        super().__init__(
            f"drawing needs OpenGL, and MUJOCO_GL={backend} does not work here ({reason}). On Debian or Ubuntu install "
            f"it with: apt-get install {_NEEDS.get(backend, _NEEDS['egl'])} (or set MUJOCO_GL to another of "
            f"{', '.join(_NEEDS)}). Everything that draws nothing works without."
        )


def mujoco_library() -> Any:
    """The ``mujoco`` module, drawing without a screen unless ``MUJOCO_GL`` says otherwise.

    Raises ``MissingExtraError`` when the extra ``sim`` is not installed, ``OpenGLMissingError`` without OpenGL.
    """
    if "MUJOCO_GL" not in os.environ and sys.platform == "linux":
        os.environ["MUJOCO_GL"] = "egl"
    try:
        return optional("mujoco", "sim")
    except MissingExtraError as error:
        if isinstance(error.__cause__, ModuleNotFoundError):
            raise
        raise OpenGLMissingError(os.environ.get("MUJOCO_GL", "glfw"), error.__cause__) from error
