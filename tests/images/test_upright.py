from __future__ import annotations

import numpy as np
import pytest

from pix2pred.images.upright import before_turning, upright, upright_numbers


@pytest.mark.parametrize("angle", [0, 12, -12, 78, 90, 102, 180, 270])
def test_a_point_of_the_upright_picture_is_found_in_the_picture_as_taken(angle: int) -> None:
    rng = np.random.default_rng(angle % 7)
    for _ in range(4):
        column, row = int(rng.integers(200, 440)), int(rng.integers(150, 330))
        taken = np.zeros((480, 640, 3), dtype=np.uint8)
        taken[row - 2 : row + 3, column - 2 : column + 3] = 255
        bright = upright(taken, angle)[..., 0].astype(float)
        rows, columns = np.mgrid[: bright.shape[0], : bright.shape[1]]
        x, y = ((columns + 0.5) * bright).sum() / bright.sum(), ((rows + 0.5) * bright).sum() / bright.sum()
        assert before_turning(x, y, (640, 480), angle) == pytest.approx((column + 0.5, row + 0.5), abs=0.05)


def test_quarter_turns_lose_nothing_and_other_turns_cut_what_was_not_seen() -> None:
    numbers = np.arange(12, dtype=np.int32).reshape(3, 4)
    assert np.array_equal(upright_numbers(numbers, 180), numbers[::-1, ::-1])
    assert np.array_equal(upright_numbers(numbers, 90), np.rot90(numbers))
    picture = np.full((480, 640, 3), 200, dtype=np.uint8)
    turned = upright(picture, 78)
    assert turned.shape == (500, 374, 3)
    height, width = turned.shape[:2]
    assert turned[0, width // 2, 0] == turned[height // 2, 0, 0] == 200
