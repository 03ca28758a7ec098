"""MuJoCo, imported only when a domain that needs it is used; where OpenGL is missing it computes but cannot draw."""

from __future__ import annotations

import importlib
import os
import sys
from functools import cache
from importlib.util import find_spec
from typing import Any

from pix2pred.system.extras import MissingExtraError, optional

_NEEDS = {"egl": "libegl1 libgl1", "osmesa": "libosmesa6", "glfw": "libglfw3 libgl1"}
_DRAWS_NOTHING = "disabled"


class OpenGLMissingError(MissingExtraError):
    """MuJoCo is installed, but no OpenGL to draw with; the message names the system packages."""

    def __init__(self, backend: str, reason: object) -> None:
        super().__init__(
            f"pictures need OpenGL, and MUJOCO_GL={backend} does not work here ({reason}). On Debian or Ubuntu install "
            f"it with: apt-get install {_NEEDS.get(backend, _NEEDS['egl'])}; or set MUJOCO_GL to another of "
            f"{', '.join(_NEEDS)} before Python starts. Everything that draws nothing works without."
        )


@cache
def mujoco_library() -> Any:
    """The ``mujoco`` module, drawing without a screen unless ``MUJOCO_GL`` says otherwise.

    Raises ``MissingExtraError`` when the extra ``sim`` is not installed. Missing OpenGL is found out by ``backend``.
    """
    if find_spec("mujoco") is None:
        return optional("mujoco", "sim")
    _missing()
    mujoco = importlib.import_module("mujoco")
    mujoco.set_mju_user_warning(lambda message: None)  # else every divergence, which we report, writes a file here
    return mujoco


def backend() -> str:
    """What MuJoCo draws with. Raises ``OpenGLMissingError`` when that could not be loaded."""
    wanted, reason = _missing()
    if reason is not None:
        raise OpenGLMissingError(wanted, reason)
    return wanted


def check_drawing() -> None:
    """Raises ``MissingExtraError`` when MuJoCo is not installed, or has nothing to draw with."""
    mujoco_library()
    backend()


@cache
def _missing() -> tuple[str, Exception | None]:
    """The OpenGL backend asked for, and why it cannot be loaded. MuJoCo is imported on the way, if need be without."""
    if "MUJOCO_GL" not in os.environ and sys.platform == "linux":
        os.environ["MUJOCO_GL"] = "egl"
    wanted = os.environ.get("MUJOCO_GL", "glfw").lower()
    try:
        importlib.import_module("mujoco")
    except Exception as error:  # the OpenGL bindings fail in many ways where the library is absent
        os.environ["MUJOCO_GL"] = _DRAWS_NOTHING
        importlib.import_module("mujoco")
        return wanted, error
    return wanted, None
