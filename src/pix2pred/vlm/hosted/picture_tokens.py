"""How many tokens a picture counts for, by the rules that providers publish; for estimates alone."""

from __future__ import annotations

from math import ceil


def picture_tokens(provider: str, width: int, height: int) -> int:
    """Input tokens of a picture of ``width`` x ``height`` pixels.

    OpenAI: 85, and 170 for every tile of 512 pixels once the picture fits into 2048 and its shorter side into 768.
    Google: 258, for every tile of 768 pixels when a side is longer than 384. Anthropic: one for 750 pixels, of at most
    1568 on the longer side. Others count in many ways; they are taken to count like OpenAI.
    """
    if provider == "google":
        return 258 if max(width, height) <= 384 else 258 * ceil(width / 768) * ceil(height / 768)
    if provider == "anthropic":
        factor = min(1.0, 1568 / max(width, height))
        return ceil(width * factor * height * factor / 750)
    factor = min(1.0, 2048 / max(width, height))
    factor *= min(1.0, 768 / (min(width, height) * factor))
    return 85 + 170 * ceil(width * factor / 512) * ceil(height * factor / 512)
