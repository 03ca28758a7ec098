"""The server of llama.cpp with a tiny model of random weights: its protocol is real. Needs the extra ``servers``."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from extras import need
from pix2pred.vlm import Finish, NoAnswerError
from vlm.real_servers import REQUEST, ask, check_usage_and_pictures, serving, view

pytestmark = need("xllamacpp", "gguf", extra="servers")
SERVE = Path(__file__).with_name("tiny_gguf.py")
SCHEMA = {
    "type": "object",
    "properties": {"lit": {"type": "boolean"}},
    "required": ["lit"],
    "additionalProperties": False,
}


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("llama")
    with serving(folder, lambda port: (SERVE, folder, str(port))) as address:
        yield address


def test_answers_come_back_with_usage_and_depend_on_every_picture(url: str) -> None:
    check_usage_and_pictures(url)


def test_an_answer_cut_short_by_its_budget_says_so(url: str) -> None:
    assert ask(url).answer(replace(REQUEST, max_tokens=2)).finish == Finish.CUT_SHORT


def test_a_schema_is_followed(url: str) -> None:
    answer = ask(url).answer(replace(REQUEST, schema=json.dumps(SCHEMA), max_tokens=400))
    assert answer.finish == Finish.CUT_SHORT or isinstance(json.loads(answer.text)["lit"], bool)


def test_probabilities_that_do_not_make_up_the_text_are_left_out(url: str) -> None:
    answer = ask(url).answer(replace(REQUEST, logprobs=True))
    assert "".join(t.text for t in answer.tokens) in ("", answer.text)


def test_more_than_the_context_holds_is_too_large(url: str) -> None:
    long = replace(REQUEST, parts=("x" * 20_000, view(20, 0)))
    assert ask(url).answer(replace(long, max_tokens=4000)).finish == Finish.TOO_LARGE
    with pytest.raises(NoAnswerError, match="context size"):
        ask(url).answer(long)
