"""Detectors of ``transformers``, with random weights made here: their answers mean nothing, their interface is real."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from extras import need
from pix2pred.structs import Box, Image

pytestmark = need("transformers", "torch", extra="detect")

LETTERS = [letter + end for letter in "!audck." for end in ("", "</w>")]
WORDS = ["<nothing>", "<|startoftext|>", "<|endoftext|>", *LETTERS]


@pytest.fixture(scope="module")
def detector_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    import json

    import torch
    from transformers import CLIPTokenizer, Owlv2Config, Owlv2ForObjectDetection, Owlv2ImageProcessor, Owlv2Processor

    torch.manual_seed(0)
    folder = tmp_path_factory.mktemp("owl")
    (folder / "vocab.json").write_text(json.dumps({w: i for i, w in enumerate(WORDS)}))
    (folder / "merges.txt").write_text("#version: 0.2\n")
    tokenizer = CLIPTokenizer(str(folder / "vocab.json"), str(folder / "merges.txt"), model_max_length=16)
    side = {"height": 64, "width": 64}
    Owlv2Processor(Owlv2ImageProcessor(size=side), tokenizer).save_pretrained(folder)
    small = {"hidden_size": 16, "intermediate_size": 16, "num_hidden_layers": 1, "num_attention_heads": 2}
    config = Owlv2Config(
        text_config=small
        | {
            "vocab_size": len(WORDS),
            "max_position_embeddings": 16,
            "pad_token_id": 2,
            "bos_token_id": 1,
            "eos_token_id": 2,
        },
        vision_config=small | {"image_size": 64, "patch_size": 16},
        projection_dim=16,
    )
    Owlv2ForObjectDetection(config).save_pretrained(folder)
    return folder


def test_boxes_lie_in_the_picture_and_have_scores(detector_folder: Path) -> None:
    from pix2pred.robots.detecting.by_transformers import TransformersDetector

    picture = Image.from_pixels(np.random.default_rng(0).integers(0, 255, (48, 96, 3), dtype=np.uint8))
    found = TransformersDetector(str(detector_folder), least_score=0.0).detect(picture, ["duck", "cud"])
    assert {d.descriptor for d in found} == {"duck", "cud"}
    assert all(0 <= d.box.left < d.box.right <= 96 and 0 <= d.box.top < d.box.bottom <= 48 for d in found)
    assert [d.score for d in found] == sorted((d.score for d in found), reverse=True)
    assert TransformersDetector(str(detector_folder), least_score=1.0).detect(picture, ["duck"]) == []


@pytest.fixture(scope="module")
def segmenter_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    import torch
    from transformers import SamConfig, SamImageProcessor, SamModel, SamProcessor

    torch.manual_seed(0)
    folder = tmp_path_factory.mktemp("sam")
    small: dict[str, Any] = {"hidden_size": 16, "num_hidden_layers": 1, "num_attention_heads": 2, "mlp_dim": 16}
    config = SamConfig(
        vision_config=small | {"image_size": 64, "patch_size": 16, "output_channels": 16, "num_pos_feats": 8,
                               "window_size": 2, "global_attn_indexes": [0], "mlp_ratio": 1.0},
        prompt_encoder_config={"hidden_size": 16, "image_size": 64, "patch_size": 16, "mask_input_channels": 4},
        mask_decoder_config=small | {"iou_head_hidden_dim": 16},
    )  # fmt: skip
    SamModel(config).save_pretrained(folder)
    size = {"longest_edge": 64}
    pad = {"height": 64, "width": 64}
    SamProcessor(SamImageProcessor(size=size, pad_size=pad)).save_pretrained(folder)
    return folder


def test_every_box_gets_an_outline_of_the_pictures_size(segmenter_folder: Path) -> None:
    from pix2pred.robots.detecting.by_transformers import TransformersSegmenter

    picture = Image.from_pixels(np.random.default_rng(0).integers(0, 255, (48, 96, 3), dtype=np.uint8))
    segmenter = TransformersSegmenter(str(segmenter_folder))
    masks = segmenter.segment(picture, [Box(0, 0, 20, 20), Box(30, 10, 90, 40)])
    assert [m.shape for m in masks] == [(48, 96), (48, 96)] and all(m.dtype == np.bool_ for m in masks)
    assert list(segmenter.segment(picture, [])) == []
