"""pix2pred: learn symbolic world models from images with vision-language models, and plan with them.

    import pix2pred as p2p

    data = p2p.read_data("data/stacks")
    model = p2p.learn(data, vlm="offline")
    found = model.plan("data/stacks/tasks/more-stacks-test-0")

Everything is loaded when it is first used: importing the package itself loads nothing else.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pix2pred.api import Model, generate, learn, load_model, read_data
    from pix2pred.demos import Project, StoredTask, write_project
    from pix2pred.execution import PlannedScene
    from pix2pred.settings import Settings
    from pix2pred.structs import Task

__version__ = "0.2.0"

__all__ = [
    "Model",
    "PlannedScene",
    "Project",
    "Settings",
    "StoredTask",
    "Task",
    "__version__",
    "generate",
    "learn",
    "load_model",
    "read_data",
    "write_project",
]

_HOMES = {
    "Model": "pix2pred.api",
    "generate": "pix2pred.api",
    "learn": "pix2pred.api",
    "load_model": "pix2pred.api",
    "read_data": "pix2pred.api",
    "Project": "pix2pred.demos",
    "StoredTask": "pix2pred.demos",
    "write_project": "pix2pred.demos",
    "PlannedScene": "pix2pred.execution",
    "Settings": "pix2pred.settings",
    "Task": "pix2pred.structs",
}


if not TYPE_CHECKING:  # a checker sees the names above, and no others

    def __getattr__(name: str) -> Any:
        if name not in _HOMES:
            raise AttributeError(f"module 'pix2pred' has no attribute {name!r}")
        value = getattr(import_module(_HOMES[name]), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return __all__
