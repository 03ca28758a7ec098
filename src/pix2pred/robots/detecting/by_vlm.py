"""A vision-language model as a detector: asked for one description at a time, its boxes are brought to pixels."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pix2pred.robots.detecting.boxes import convention_of, normalised, written_boxes
from pix2pred.robots.detecting.detector import Detection
from pix2pred.structs import Box, Image, Picture
from pix2pred.structs.views import View
from pix2pred.vlm import VLM, Purpose, Request

PROMPT = (Path(__file__).parent / "prompts" / "detect.txt").read_text(encoding="utf-8")

MAX_TOKENS = 800
"""Room for a dozen boxes, and for a model that explains itself all the same."""

LATER = 0.9
"""Every further box of an answer is taken to be so much less sure: models write the surest first, and no scores."""


class VLMDetector:
    """Asks ``vlm``; how it writes boxes is told by every answer."""

    def __init__(self, vlm: VLM) -> None:
        self._vlm = vlm

    def detect(self, picture: Image, descriptors: Sequence[str]) -> Sequence[Detection]:
        found: list[Detection] = []
        for descriptor in descriptors:
            view = View(Picture("scene", picture, {}), 0, marks=False)
            request = Request(Purpose.DETECT, (PROMPT.format(descriptor=descriptor), view), MAX_TOKENS)
            written = written_boxes(self._vlm.answer(request).text)
            shown = view.shown_size
            how = convention_of(written, shown)
            boxes = [b for w in written if (b := normalised(w, shown, how)) is not None]
            scale = picture.size[0] / shown[0], picture.size[1] / shown[1]
            found += [
                Detection(descriptor, Box(b.left * scale[0], b.top * scale[1], b.right * scale[0], b.bottom * scale[1]),
                          LATER**i)
                for i, b in enumerate(boxes)
            ]  # fmt: skip
        return sorted(found, key=lambda d: -d.score)
