from __future__ import annotations

import os

import pytest

from pix2pred.domains.home.world import Body, World
from pix2pred.system.extras import MissingExtraError


@pytest.fixture(scope="session")
def drawing() -> None:
    """Skip without MuJoCo or without OpenGL to draw with; fail where nothing may be skipped."""
    from pix2pred.domains.home.cameras import pixels_of

    try:
        pixels_of(World((), Body.HUMAN), "head")
    except MissingExtraError as error:
        if os.environ.get("PIX2PRED_NO_SKIPS") == "1":
            pytest.fail(str(error), pytrace=False)
        pytest.skip(str(error))
