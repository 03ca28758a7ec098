"""What goes over the wire, and what is read from what comes back."""

from __future__ import annotations

import base64
import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from http.server import BaseHTTPRequestHandler

import numpy as np
import pytest

from extras import need
from pix2pred.images import ShownPictures, draw_view
from pix2pred.registry import REGISTRY
from pix2pred.structs import Image, Picture
from pix2pred.structs.views import View
from pix2pred.vlm import Finish, FlowSettings, NoAnswerError, Purpose, Request, VLMError
from pix2pred.vlm.control.flow import TransientError
from pix2pred.vlm.hosted.anthropic import Anthropic
from pix2pred.vlm.hosted.client import HostedVLM
from pix2pred.vlm.hosted.google import Google
from pix2pred.vlm.hosted.openai import OpenAI
from pix2pred.vlm.hosted.openai_compatible import OpenAICompatible
from pix2pred.vlm.hosted.pricing import dollars
from pix2pred.vlm.hosted.probabilities import tokens_of
from pix2pred.vlm.hosted.provider import Provider
from pix2pred.vlm.hosted.spec import HostedSpec, hosted_model
from pix2pred.vlm.model_spec import ModelNameError
from vlm.fault_server import FaultServer, _send, pictures, text

VIEWS = [
    View(
        Picture("main", Image.from_pixels(np.random.default_rng(t).integers(0, 256, (30, 40, 3), dtype=np.uint8))),
        t,
        heading=f"state {t}, camera main",
    )
    for t in range(3)
]
REQUEST = Request(
    Purpose.LABEL, ("First this.", VIEWS[0], "Then that.", *VIEWS[1:], "\nPredicates:\nlit(a)"), 777, 0.5, 2, 3
)


@pytest.fixture
def server() -> Iterator[FaultServer]:
    with FaultServer().running() as running:
        yield running


def hosted(server: FaultServer, timeout: float = 60.0) -> HostedVLM:
    return HostedVLM(
        hosted_model(OpenAICompatible(), f"tiny@{server.url}"), ShownPictures(), FlowSettings(timeout=timeout)
    )


def test_text_and_pictures_go_in_order_losslessly_with_headings_and_settings(server: FaultServer) -> None:
    answer = hosted(server).answer(REQUEST)
    (body,) = map(json.loads, server.bodies)
    content = body["messages"][0]["content"]
    assert [part["type"] for part in content] == ["text", "image_url", "text", "image_url", "image_url", "text"]
    for view, url in zip(VIEWS, pictures(body), strict=True):
        shown = Image(base64.b64decode(url.removeprefix("data:image/png;base64,")))
        assert np.array_equal(shown.pixels(), draw_view(view)), "crop, size, marks and heading, pixel by pixel"
        assert max(shown.size) >= 512
    assert "First this.\n\nThen that." in text(body)
    assert (body["model"], body["max_tokens"], body["temperature"], body["seed"]) == ("tiny", 777, 0.5, 2003)
    assert "logprobs" not in body and "response_format" not in body
    assert answer.finish == Finish.COMPLETE and (answer.spent.input_tokens, answer.spent.output_tokens) == (100, 10)
    assert answer.spent.dollars is None


def test_the_next_pictures_are_drawn_while_the_model_thinks_and_not_sent() -> None:
    drawn: list[tuple[int, bool]] = []
    with FaultServer(places=0).running() as server:
        vlm = hosted(server)
        draw = ShownPictures()

        def told(view: View) -> bytes:
            drawn.append((view.state, bool(server.answered)))
            if view.state == 2:
                server.let_one_in()
            return draw(view)

        vlm._draw = told
        broken = View(Picture("main", Image(b"no picture")), 9)
        vlm.answer(replace(REQUEST, parts=(VIEWS[0], "lit(a)"), upcoming=(VIEWS[1], broken, VIEWS[2])))
        assert drawn == [(0, False), (1, False), (9, False), (2, False)], "before the answer; a bad one stops nothing"
        (body,) = map(json.loads, server.bodies)
        assert len(pictures(body)) == 1


def test_probabilities_and_a_schema_are_asked_for_when_wanted(server: FaultServer) -> None:
    schema = json.dumps({"type": "object", "properties": {}, "additionalProperties": False, "required": []})
    hosted(server).answer(replace(REQUEST, logprobs=True, schema=schema))
    (body,) = map(json.loads, server.bodies)
    assert body["logprobs"] is True and body["top_logprobs"] == 5
    assert body["response_format"]["type"] == "json_schema"


@pytest.mark.parametrize(
    ("fault", "kind"),
    [(f, TransientError) for f in ("429", "500", "502", "cut before", "cut within", "half json", "not json", "late")],
)
def test_each_failure_has_its_kind(fault: str, kind: type[Exception]) -> None:
    with FaultServer({fault: 1.0}).running() as server, pytest.raises(kind):
        hosted(server, 0.8).answer(REQUEST)


def test_waiting_times_are_passed_on() -> None:
    with FaultServer({"429 with time": 1.0}).running() as server, pytest.raises(TransientError) as caught:
        hosted(server).answer(REQUEST)
    assert caught.value.retry_after == pytest.approx(0.02)


@pytest.mark.parametrize(
    ("fault", "finish"),
    [
        ("empty", Finish.COMPLETE),
        ("refused", Finish.REFUSED),
        ("filtered", Finish.REFUSED),
        ("truncated", Finish.CUT_SHORT),
    ],
)
def test_how_an_answer_ended_is_noticed(fault: str, finish: Finish) -> None:
    with FaultServer({fault: 1.0}).running() as server:
        assert hosted(server).answer(REQUEST).finish == finish


@pytest.mark.parametrize(
    ("status", "message", "kind"),
    [
        (400, "the prompt is too long", NoAnswerError),
        (400, "Server is pinned to 'a/b'; requested model 'tiny' is not served: model not found", VLMError),
        (404, "no such route", VLMError),
        (401, "wrong key", VLMError),
        (402, "no credit", VLMError),
        (503, "overloaded", TransientError),
    ],
)
def test_refusals_are_told_apart(status: int, message: str, kind: type[VLMError]) -> None:
    with refusing(status, message).running() as server, pytest.raises(VLMError, match=str(status)) as caught:
        hosted(server).answer(REQUEST)
    assert type(caught.value) is kind and message[:20] in str(caught.value)


@pytest.mark.parametrize(
    "message",
    [
        "max_tokens is too large: 52224. This model supports at most 16384 completion tokens",
        "max_tokens: 52224 > 8192, which is the maximum allowed number of output tokens",
        "'max_tokens' is too large: 52224. This model's maximum context length is 8192 tokens",
        "Unable to submit request because it has a maxOutputTokens value of 99999",
        "the request exceeds the available context size",
    ],
)
def test_a_budget_the_model_does_not_have_is_told_apart_until_it_is_small(message: str) -> None:
    with refusing(400, message).running() as server:
        vlm = hosted(server)
        assert vlm.answer(replace(REQUEST, max_tokens=52224)).finish == Finish.TOO_LARGE
        with pytest.raises(NoAnswerError, match="400"):
            vlm.answer(REQUEST)


def test_a_budget_by_another_name_is_no_budget_too_large() -> None:
    said = "Unsupported parameter: 'max_tokens'. Use another"
    with refusing(400, said).running() as server, pytest.raises(NoAnswerError, match="Unsupported"):
        hosted(server).answer(replace(REQUEST, max_tokens=52224))


def refusing(status: int, message: str) -> FaultServer:
    class Refusing(FaultServer):
        def serve(self, handler: BaseHTTPRequestHandler) -> None:
            handler.rfile.read(int(handler.headers["content-length"]))
            _send(handler, status, json.dumps({"error": {"message": message}}).encode())

    return Refusing()


def test_names_of_models() -> None:
    model = hosted_model(OpenAICompatible(), "org/qwen2.5-vl:7b@http://localhost:8000/v1/")
    assert (model.model, model.url) == ("org/qwen2.5-vl:7b", "http://localhost:8000/v1")
    assert "localhost" not in model.name
    spec = REGISTRY.model_spec("google:gemini-2.0-flash")
    assert isinstance(spec, HostedSpec) and spec.model.name == "google:gemini-2.0-flash"


@pytest.mark.parametrize(
    "bad",
    [
        "", "gpt-4o", "openai:", "openai-compatible:x", "openai-compatible:x@ftp://y", "mailbox:", "azure:x",
        "offline:x", "openai-compatible:x@http://y:port/v1", "openai-compatible:x@http://y:99999/v1",
        "openai-compatible:x@http://[::1/v1", "openai-compatible:x@http://y\x1b[31m/v1", "openai:gpt\n4",
        "openai-compatible:x@http://exa\u2100mple/v1", "openai-compatible:x@http://", "openai-compatible:x@http://a b/",
    ],
)  # fmt: skip
def test_what_names_no_model_is_told_in_plain_characters(bad: str) -> None:
    with pytest.raises(ModelNameError) as caught:
        REGISTRY.model_spec(bad)
    assert str(caught.value).isprintable()


def test_prices_are_known_for_known_models_alone() -> None:
    assert dollars("openai", "gpt-4o", 1_000_000, 0) == pytest.approx(2.5)
    assert dollars("openai-compatible", "tiny", 100, 10) is None


def test_tokens_that_do_not_make_up_the_text_are_not_believed() -> None:
    said = [{"token": "Tr", "logprob": -0.1, "top_logprobs": None}, {"token": "ue", "logprob": 0.0}]
    assert [t.text for t in tokens_of(said, "True")] == ["Tr", "ue"]
    assert tokens_of(said, "Truer") == () and tokens_of(None, "True") == ()


@pytest.mark.parametrize(
    "provider",
    [
        OpenAI(),
        pytest.param(Anthropic(), marks=need("anthropic", extra="anthropic")),
        pytest.param(Google(), marks=need("google.genai", extra="google")),
    ],
)
def test_clients_of_all_providers_can_be_made(provider: Provider, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("OPENAI_API_KEY", "ANTHROPIC_API_KEY", "GOOGLE_API_KEY"):
        monkeypatch.setenv(name, "sk-not-a-key-000000")
    vlm = HostedVLM(hosted_model(provider, "some-model"), ShownPictures(), FlowSettings(timeout=5.0))
    assert vlm.name == f"{provider.name}:some-model" and "sk-not" not in repr(vars(vlm).keys())


def test_naming_a_model_loads_no_client_library() -> None:
    code = (
        "import sys, pix2pred.registry, pix2pred.cli.app; "
        "print(sorted({'pydantic_ai', 'openai', 'anthropic', 'httpx2', 'genai_prices'} & set(sys.modules)))"
    )
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert printed.strip() == "[]"
