"""The sight that looks into vessels: the opening of a box, like colours, and cameras that are read alone."""

from __future__ import annotations

import numpy as np
import pytest

from pix2pred.structs import Box, Image, Picture
from pix2pred.vlm.offline.fine_sight import FineScene
from pix2pred.vlm.offline.inner_sight import InnerScene
from pix2pred.vlm.offline.model import Classifier, ReaderModel, WordListDoc

TYPES = {"plum": "fruit", "cup": "vessel"}
PLUM, LIME, GREY = (92, 31, 107), (92, 168, 36), (150, 150, 150)


def scene(inside: tuple[int, int, int], camera: str = "above", height: int = 60) -> InnerScene:
    """A plum beside a red cup of some height whose upper half shows ``inside``."""
    pixels = np.full((120, 200, 3), 200, dtype=np.uint8)
    pixels[20:50, 20:50] = PLUM
    pixels[20:24, 20:24] = 0  # a box of one colour counts as blank
    pixels[20 : 20 + height, 100:140] = (190, 20, 20)
    pixels[20 : 20 + height // 2, 104:136] = inside
    boxes = {"plum": Box(20, 20, 50, 50), "cup": Box(100, 20, 140, 20 + height)}
    return InnerScene(Picture(camera, Image.from_pixels(pixels), boxes), types=TYPES, kinds=("fruit", "vessel"))


@pytest.mark.parametrize("height", [36, 60, 90])
def test_what_is_in_a_vessel_of_any_height_is_compared_with_the_colour_of_a_fruit(height: int) -> None:
    """The first number is the share of the opening that is very like the fruit."""
    own = len(FineScene.relation(scene(PLUM, height=height), "plum", "cup"))
    like, unlike, empty = (scene(c, height=height).relation("plum", "cup")[own] for c in (PLUM, LIME, GREY))
    assert like > 0.8
    assert unlike == empty == 0


def test_crops_have_the_lengths_of_their_parts() -> None:
    crops = scene(PLUM).crops("cup")
    assert crops is not None and len(crops) == sum(InnerScene.blocks)
    assert len(InnerScene.blocks) == len(InnerScene.components)


class ByCamera(ReaderModel):
    """Says True with the probability that a picture's camera has."""

    def value(self, word, names, types, scene):  # type: ignore[no-untyped-def]
        p = {"above": 0.3, "below": 0.999}[scene.picture.camera]
        return p > 0.5, p


def test_where_a_decisive_camera_shows_the_objects_the_others_are_not_read() -> None:
    words = WordListDoc(format="pix2pred-reader", version=1, neighbours=("vessel",), words=())
    below, above = scene(PLUM, "below"), scene(PLUM, "above")
    reads = []
    for decisive in ((), ("above",)):
        none: dict[tuple[str, ...], Classifier] = {}
        model = ByCamera(words.model_copy(update={"decisive": decisive}), {}, none, "")
        reads.append(model.joint_value("Full", ["cup"], ["vessel"], [below, above])[0])
    assert reads == [True, False]
    assert model.joint_value("Full", ["cup"], ["vessel"], [below])[0] is True
