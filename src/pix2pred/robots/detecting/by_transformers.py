"""Open-vocabulary detectors and segmenters of the ``transformers`` library, on this machine (extra ``detect``).

Any model that the library's zero-shot object detection takes: Grounding DINO, OWL-ViT, OWLv2 and others; and for
outlines any that its mask generation takes with boxes: SAM, SAM 2. ``model`` is a folder, or a name that is downloaded.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import PIL.Image

from pix2pred.robots.detecting.detector import Detection, Mask, clipped
from pix2pred.structs import Box, Image
from pix2pred.system.extras import optional

LEAST_SCORE = 0.2
"""Boxes below it are mostly of something else: the authors of Grounding DINO use 0.25, those of OWLv2 0.1 to 0.3."""


class TransformersDetector:
    """Finds described objects; each description is asked for by itself, so that they do not compete."""

    def __init__(self, model: str, least_score: float = LEAST_SCORE) -> None:
        library = optional("transformers", "detect")
        self._pipeline: Any = library.pipeline("zero-shot-object-detection", model=model, device="cpu")
        self._least = least_score

    def detect(self, picture: Image, descriptors: Sequence[str]) -> Sequence[Detection]:
        image = PIL.Image.fromarray(picture.pixels())
        found = []
        for descriptor in descriptors:
            for entry in self._pipeline(image, candidate_labels=[f"{descriptor}."], threshold=self._least):
                b = entry["box"]
                box = clipped(Box(float(b["xmin"]), float(b["ymin"]), float(b["xmax"]), float(b["ymax"])), image.size)
                if box is not None:
                    found.append(Detection(descriptor, box, float(entry["score"])))
        return sorted(found, key=lambda d: (-d.score, d.descriptor))


class TransformersSegmenter:
    """The pixels of the object in each box."""

    def __init__(self, model: str) -> None:
        library = optional("transformers", "detect")
        self._torch = optional("torch", "detect")
        self._processor: Any = library.AutoProcessor.from_pretrained(model)
        self._model: Any = library.AutoModelForMaskGeneration.from_pretrained(model).eval()

    def segment(self, picture: Image, boxes: Sequence[Box]) -> Sequence[Mask]:
        if not boxes:
            return []
        image = PIL.Image.fromarray(picture.pixels())
        corners = [[[b.left, b.top, b.right, b.bottom] for b in boxes]]
        inputs = self._processor(images=image, input_boxes=corners, return_tensors="pt")
        with self._torch.no_grad():
            outputs = self._model(**inputs, multimask_output=False)
        sizes = [inputs["original_sizes"]]
        if "reshaped_input_sizes" in inputs:
            sizes.append(inputs["reshaped_input_sizes"])
        masks = self._processor.post_process_masks(outputs.pred_masks, *sizes)[0]
        return [np.asarray(mask[0] > 0, dtype=np.bool_) for mask in masks]
