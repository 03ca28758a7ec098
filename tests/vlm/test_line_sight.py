"""The sight that looks for what is drawn on things: thin lines count, things and broad shades do not."""

from __future__ import annotations

import numpy as np
import PIL.Image
import PIL.ImageDraw
import pytest

from pix2pred.structs import Box, Image, Picture
from pix2pred.vlm.offline.fine_sight import FineScene
from pix2pred.vlm.offline.line_sight import LineScene
from pix2pred.vlm.offline.model import WordListDoc

TYPES = {"desk": "table", "block": "thing"}
INK = [(190, 30, 30), (20, 30, 150), (25, 25, 25), (20, 120, 40)]


def picture(line: tuple[int, int, int] | None, width: int = 4, times: int = 1) -> Picture:
    """A pale table with a blue block on it and, if wanted, a line across its right half."""
    image = PIL.Image.new("RGB", (300 * times, 200 * times), (120, 110, 100))
    draw = PIL.ImageDraw.Draw(image)
    draw.rectangle([40 * times, 30 * times, 260 * times, 150 * times], fill=(225, 222, 215))
    draw.rectangle([60 * times, 50 * times, 100 * times, 90 * times], fill=(40, 70, 190))
    if line is not None:
        draw.line([(160 * times, 60 * times), (250 * times, 120 * times)], fill=line, width=width * times)
    boxes = {"desk": Box(40, 30, 260, 150), "block": Box(58, 48, 102, 92)}
    scaled = {n: Box(b.left * times, b.top * times, b.right * times, b.bottom * times) for n, b in boxes.items()}
    return Picture("above", Image.from_pixels(np.asarray(image)), scaled)


def lines(shown: Picture) -> np.ndarray:
    """What the sight adds about the table."""
    scene = LineScene(shown, types=TYPES, kinds=("table", "thing"), drawn_on=("table",))
    return scene.surroundings("desk")[len(FineScene.surroundings(scene, "desk")) :]


@pytest.mark.parametrize("ink", INK)
@pytest.mark.parametrize("times", [1, 2])
def test_a_thin_line_of_any_ink_is_seen_where_it_is_at_any_distance(ink: tuple[int, int, int], times: int) -> None:
    clean, drawn = lines(picture(None, times=times)), lines(picture(ink, times=times))
    assert clean.max() == 0
    assert drawn[-3] > 0.01
    cells = drawn[:-3].reshape(4, 5, 3)[..., 0]
    assert cells[:, :2].max() == 0 and cells[:, 2:].max() > 0.02


def test_of_a_broad_shade_only_corners_count() -> None:
    assert lines(picture((60, 60, 60), width=40))[-3] < lines(picture((60, 60, 60)))[-3] / 4


def test_only_types_that_are_drawn_on_are_looked_at_and_a_word_list_says_which() -> None:
    words = WordListDoc(format="pix2pred-reader", version=1, neighbours=("thing",), drawn_on=("table",), words=())
    scene = words.scene(picture(INK[0]), TYPES)
    assert isinstance(scene, LineScene)
    plain = FineScene(picture(INK[0]), types=TYPES, kinds=("thing",))
    assert len(scene.surroundings("desk")) > len(plain.surroundings("desk"))
    assert np.array_equal(scene.surroundings("block"), plain.surroundings("block"))
