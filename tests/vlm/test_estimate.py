"""What pictures and repeated text count for in estimates."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pix2pred.registry import REGISTRY
from pix2pred.structs import Image, Picture
from pix2pred.structs.views import View
from pix2pred.vlm import Answer, AnswerStore, Purpose, Request, StoredVLM, StoreMode
from pix2pred.vlm.answers.replay import AbsentVLM
from pix2pred.vlm.control.estimate import EstimatingVLM
from pix2pred.vlm.control.repeated import Beginning, Repeated
from pix2pred.vlm.hosted.anthropic import Anthropic
from pix2pred.vlm.hosted.google import Google
from pix2pred.vlm.hosted.openai import OpenAI
from pix2pred.vlm.hosted.pricing import dollars
from pix2pred.vlm.hosted.provider import Provider
from pix2pred.vlm.request import Part, Spent


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


class TestRepeated:
    """What a question shares with earlier ones, from its beginning on."""

    SAME = "x" * 8000

    def _request(self, *parts: Part) -> Request:
        return Request(Purpose.LABEL, parts, 100)

    def test_nothing_is_repeated_at_first(self) -> None:
        assert Repeated().beginning(self._request(self.SAME)) == Beginning()

    @given(st.text("ab", max_size=40), st.text("ab", max_size=40))
    def test_it_is_the_common_beginning(self, one: str, other: str) -> None:
        repeated = Repeated()
        repeated.beginning(self._request(one))
        found = repeated.beginning(self._request(other)).characters
        assert one[:found] == other[:found]
        assert one == other or one[found : found + 1] != other[found : found + 1]

    def test_pictures_count_while_all_before_them_is_the_same(self) -> None:
        shown, other = (
            View(Picture("main", Image.from_pixels(np.full((4, 4, 3), i, np.uint8)), {}), 0) for i in (0, 1)
        )
        repeated = Repeated()
        repeated.beginning(self._request("stable", shown, "tail"))
        assert repeated.beginning(self._request("stable", shown, "tall")) == Beginning(
            len("stableta"), ("stable", shown)
        )
        assert repeated.beginning(self._request("stable", other, "tail")) == Beginning(len("stable"), ("stable",))
        assert repeated.beginning(self._request("staple", shown)) == Beginning(len("sta"), ())


@pytest.mark.parametrize(("repeated", "cached"), [(0, 0), (1023, 0), (1024, 1024), (1151, 1024), (1152, 1152)])
def test_short_beginnings_are_not_cached(repeated: int, cached: int) -> None:
    assert OpenAI().cached_tokens(repeated) == cached


def test_an_estimate_says_what_would_come_from_the_cache_whatever_the_order(tmp_path: Path) -> None:
    spec = REGISTRY.model_spec("openai:gpt-4o")
    requests = [Request(Purpose.LABEL, (f"{'y' * 8000}{i}",), 100, about=f"d, state {i}") for i in range(4)]
    counted = []
    for order in (requests, requests[::-1]):
        stored = StoredVLM(AbsentVLM("m"), AnswerStore(tmp_path), StoreMode.REPLAY)
        estimating = EstimatingVLM(lambda counted, stored=stored: counted(stored), spec.rates)  # type: ignore[misc]
        for request in order:
            estimating.answer(request)
        counted.append(estimating.as_dict()["cached_tokens"])
    assert counted == [3 * 1920] * 2


def test_cached_tokens_cost_less_and_are_kept_in_the_store(tmp_path: Path) -> None:
    full, less = dollars("openai", "gpt-4o", 10_000, 100), dollars("openai", "gpt-4o", 10_000, 100, 8_000)
    assert full is not None and less is not None and less < full
    request = Request(Purpose.LABEL, ("q",), 100)
    store = AnswerStore(tmp_path)
    store.put(request, "m", Answer("a", spent=Spent(10_000, 100, less, cached_tokens=8_000)))
    kept = store.get(request.key("m"))
    assert kept is not None and kept.spent.cached_tokens == 8_000
