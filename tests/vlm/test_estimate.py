"""What pictures count for in estimates."""

from __future__ import annotations

import pytest

from pix2pred.vlm.hosted.picture_tokens import picture_tokens


@pytest.mark.parametrize(
    ("provider", "size", "tokens"),
    [
        ("openai", (512, 410), 255),
        ("openai", (512, 558), 425),
        ("openai", (1024, 1024), 765),  # 768 x 768: four tiles
        ("openai", (4096, 2048), 1105),  # 2048 x 1024, then 1536 x 768: six tiles
        ("google", (300, 384), 258),
        ("google", (512, 558), 258),
        ("google", (1024, 810), 4 * 258),
        ("anthropic", (512, 558), 381),
        ("anthropic", (3136, 1500), 1568),
    ],
)
def test_tokens_of_a_picture(provider: str, size: tuple[int, int], tokens: int) -> None:
    assert picture_tokens(provider, *size) == tokens
