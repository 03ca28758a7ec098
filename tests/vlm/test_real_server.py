"""A real third-party server, ``transformers serve``, with a tiny model of random weights: its protocol is real.

Needs the extra ``servers``.
"""

from __future__ import annotations

import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from extras import need
from pix2pred.vlm import NoAnswerError, VLMError
from vlm.real_servers import QUIET, REQUEST, ask, check_usage_and_pictures, serving

pytestmark = need("torch", "transformers", "fastapi", "uvicorn", extra="servers")
BUILD = Path(__file__).with_name("tiny_model.py")
SERVE = "import sys; from transformers.cli.transformers import main; sys.argv[0] = 'transformers'; main()"


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("server")
    subprocess.run([sys.executable, BUILD, folder / "tiny"], check=True, env=QUIET, timeout=300)
    options = ("--host", "127.0.0.1", "--device", "cpu", "--default-seed", "0")
    with serving(folder, lambda port: ("-c", SERVE, "serve", "tiny", "--port", str(port), *options)) as address:
        yield address


def test_answers_come_back_with_usage_and_depend_on_every_picture(url: str) -> None:
    check_usage_and_pictures(url)


def test_what_the_server_ignores_silently_does_no_harm(url: str) -> None:
    schema = '{"type": "object", "properties": {}, "required": [], "additionalProperties": false}'
    answer = ask(url).answer(replace(REQUEST, logprobs=True, schema=schema))
    assert answer.text and answer.tokens == (), "probabilities were asked for and did not come"


def test_an_unknown_model_ends_the_run(url: str) -> None:
    with pytest.raises(VLMError, match="knows no such model") as caught:
        ask(url, "another").answer(REQUEST)
    assert not isinstance(caught.value, NoAnswerError) and "400" in str(caught.value)


@pytest.mark.parametrize("broken", [{"stop": ["x"]}, {"image": "data:image/png;base64,iVBORw0KGgo="}])
def test_what_the_server_answers_with_an_error_is_never_sent(url: str, broken: dict[str, object]) -> None:
    """The quirk itself, by hand: ``stop`` and damaged pictures are refused with an error of the server."""
    import json

    content: list[dict[str, object]] = [{"type": "text", "text": "x"}]
    if "image" in broken:
        content.append({"type": "image_url", "image_url": {"url": broken["image"]}})
    body = {"model": "tiny", "max_tokens": 4, "messages": [{"role": "user", "content": content}]}
    body |= {k: v for k, v in broken.items() if k == "stop"}
    request = urllib.request.Request(
        f"{url}/chat/completions", json.dumps(body).encode(), {"content-type": "application/json"}
    )
    with pytest.raises(urllib.error.HTTPError) as caught:
        urllib.request.urlopen(request, timeout=60)
    assert caught.value.code in (400, 422, 500)
