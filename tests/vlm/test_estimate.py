"""What pictures count for in estimates."""

from __future__ import annotations

import pytest

from pix2pred.vlm.hosted.anthropic import Anthropic
from pix2pred.vlm.hosted.google import Google
from pix2pred.vlm.hosted.openai import OpenAI
from pix2pred.vlm.hosted.provider import Provider


@pytest.mark.parametrize(
    ("provider", "size", "tokens"),
    [
        (OpenAI(), (512, 410), 255),
        (OpenAI(), (512, 558), 425),
        (OpenAI(), (1024, 1024), 765),  # 768 x 768: four tiles
        (OpenAI(), (4096, 2048), 1105),  # 2048 x 1024, then 1536 x 768: six tiles
        (Google(), (300, 384), 258),
        (Google(), (512, 558), 258),
        (Google(), (1024, 810), 4 * 258),
        (Anthropic(), (512, 558), 381),
        (Anthropic(), (3136, 1500), 1568),
    ],
)
def test_tokens_of_a_picture(provider: Provider, size: tuple[int, int], tokens: int) -> None:
    assert provider.picture_tokens(*size) == tokens
