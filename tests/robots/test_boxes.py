"""Boxes that models write, in the scales and orders in which they do."""

from __future__ import annotations

import itertools
import json

import numpy as np
import pytest

from pix2pred.robots.detecting.boxes import (
    Convention,
    Order,
    Scale,
    WrittenBox,
    convention_of,
    normalised,
    written_boxes,
)
from pix2pred.robots.detecting.by_vlm import VLMDetector
from pix2pred.robots.detecting.detector import Detection, best_boxes, clipped
from pix2pred.structs import Box, Image
from pix2pred.vlm import Answer, Request

SIZE = (640, 480)
TRUTH = Box(320.0, 120.0, 560.0, 360.0)


def write(box: Box, how: Convention) -> tuple[float, float, float, float]:
    x, y = {Scale.PIXELS: (1.0, 1.0), Scale.SHARES: (1 / 640, 1 / 480)}.get(how.scale, (1000 / 640, 1000 / 480))
    corners = (box.left * x, box.top * y, box.right * x, box.bottom * y)
    a, b, c, d = corners
    return corners if how.order is Order.X_Y else (b, a, d, c)


@pytest.mark.parametrize(("scale", "order"), list(itertools.product(Scale, Order)))
def test_a_box_comes_back_from_every_convention(scale: Scale, order: Order) -> None:
    how = Convention(scale, order)
    back = normalised(WrittenBox(write(TRUTH, how)), SIZE, how)
    assert back is not None
    assert np.allclose([back.left, back.top, back.right, back.bottom], [320, 120, 560, 360])


@pytest.mark.parametrize(
    ("answer", "how"),
    [
        ('[{"bbox_2d": [320, 120, 560, 360], "label": "duck"}]', Convention(Scale.PIXELS, Order.X_Y)),
        ('```json\n[{"box_2d": [250, 500, 750, 875], "label": "duck"}]\n```', Convention(Scale.THOUSANDTHS, Order.Y_X)),
        ("The duck is at [0.5, 0.25, 0.875, 0.75].", Convention(Scale.SHARES, Order.X_Y)),
        ('{"bbox": [500, 250, 875, 750]}', Convention(Scale.THOUSANDTHS, Order.X_Y)),
    ],
)
def test_the_convention_is_told_from_the_answer(answer: str, how: Convention) -> None:
    boxes = written_boxes(answer)
    assert convention_of(boxes, SIZE) == how
    back = normalised(boxes[0], SIZE, how)
    assert back is not None and np.allclose([back.left, back.top, back.right, back.bottom], [320, 120, 560, 360])


def test_the_order_is_told_when_only_one_fits_into_the_picture() -> None:
    boxes = [WrittenBox((100.0, 500.0, 300.0, 620.0))]
    assert convention_of(boxes, SIZE) == Convention(Scale.PIXELS, Order.Y_X)


def test_location_tokens_are_read() -> None:
    (box,) = written_boxes("<loc0256><loc0512><loc0768><loc0896> duck")
    assert box.label == "duck" and box.y_first
    back = normalised(box, SIZE, convention_of([box], SIZE))
    assert back is not None and np.allclose([back.left, back.top], [320, 120])


@pytest.mark.parametrize(
    "answer", ["", "I see no duck.", "[]", '[{"bbox_2d": [1, 2, 3]}]', '{"bbox": "all of it"}', "[[["]
)
def test_no_box_is_read_from_what_holds_none(answer: str) -> None:
    assert written_boxes(answer) == []


def test_boxes_are_clipped_and_empty_ones_dropped() -> None:
    how = Convention(Scale.PIXELS, Order.X_Y)
    assert normalised(WrittenBox((-50.0, -10.0, 700.0, 100.0)), SIZE, how) == Box(0.0, 0.0, 640.0, 100.0)
    assert normalised(WrittenBox((50.0, 60.0, 50.0, 90.0)), SIZE, how) is None
    assert clipped(Box(700.0, 0.0, 800.0, 10.0), SIZE) is None


def test_objects_with_the_same_description_share_the_boxes_out() -> None:
    a, b = Box(0, 0, 10, 10), Box(20, 0, 30, 10)
    found = [Detection("red cup", b, 0.4), Detection("red cup", a, 0.9)]
    assert best_boxes(found, {"cup2": "red cup", "cup1": "red cup", "jug": "jug"}) == {"cup1": a, "cup2": b}


class Seer:
    name = "seer"

    def __init__(self) -> None:
        self.asked: list[Request] = []

    def answer(self, request: Request) -> Answer:
        self.asked.append(request)
        width, height = request.views[0].shown_size
        if "duck" not in request.text:
            return Answer("[]")
        boxes = [[0.5 * width, 0.25 * height, 0.75 * width, 0.5 * height], [0, 0, 0.1 * width, 0.1 * height]]
        return Answer(json.dumps([{"bbox_2d": b, "label": "duck"} for b in boxes]))


def test_a_vision_language_model_is_asked_for_one_description_at_a_time_and_for_the_picture_as_it_is_shown() -> None:
    seer = Seer()
    picture = Image.from_pixels(np.zeros((1200, 1600, 3), dtype=np.uint8))
    found = VLMDetector(seer).detect(picture, ["yellow duck", "red block"])
    assert len(seer.asked) == 2
    assert [d.descriptor for d in found] == ["yellow duck", "yellow duck"]
    assert found[0].score > found[1].score
    best = found[0].box
    assert np.allclose([best.left, best.top, best.right, best.bottom], [800, 300, 1200, 600])
