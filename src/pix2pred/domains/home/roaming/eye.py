"""What the cameras of a walking robot take: colours, distances, and which object every pixel shows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pix2pred.domains.home.cameras import Eye
from pix2pred.domains.home.stage import PhysicalScene


class RoamingEye(Eye):
    """Adds distances to what an eye sees."""

    def __init__(self, stage: PhysicalScene) -> None:
        super().__init__(stage)

    def depth(self, camera: str) -> NDArray[np.float32]:
        """Metres along the camera's axis at every pixel; clear glass is seen through."""
        self._renderer.enable_depth_rendering()
        self.stage.clear_glass(hidden=True)
        try:
            self._look(camera)
            return np.array(self._renderer.render(), dtype=np.float32)
        finally:
            self._renderer.disable_depth_rendering()
            self.stage.clear_glass(hidden=False)
