"""What servers say about pictures, and thinking that hides in unusual places: many wordings of a few causes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from pix2pred.registry import REGISTRY
from pix2pred.vlm import VLM, FlowSettings, NoAnswerError, Purpose, Request, VLMError
from pix2pred.vlm.hosted.spoken import spoken
from vlm.fault_server import FaultServer
from vlm.odd_server import Reply, Scripted, refused, running, said
from vlm.real_servers import view

FAST = FlowSettings(first_pause=0.0, longest_pause=0.0, tries=4, timeout=60.0)
EIGHT = Request(Purpose.PROPOSE, ("What changes?", *(view(20, n) for n in range(8))), 400)
LABEL = replace(EIGHT, purpose=Purpose.LABEL)


def asked_of(server: FaultServer) -> VLM:
    return REGISTRY.vlm(f"openai-compatible:tiny@{server.url}", None, FAST)


def told(message: str, status: int = 400) -> VLMError:
    """The error in which a server's message ends; it is asked once."""
    with running(Scripted(lambda body: refused(message, status))) as server:
        with pytest.raises(VLMError) as caught:
            asked_of(server).answer(EIGHT)
        assert len(server.asked) == 1
    return caught.value


@pytest.mark.parametrize("message", [
    "this model is missing data required for image input",
    "No endpoints found that support image input",
    "messages[0]: unknown variant `image_url`, expected `text` at line 1 column 60",
    "model-x is not a multimodal model None",
    "Model does not support images. Please use a model that does.",
    "Invalid content type. image_url is only supported by certain models.",
    "This endpoint doesn't accept image content",
    "vision is not enabled for this deployment",
    "The requested model cannot take image inputs",
    "model does not have vision capability",
    "image input is disabled",
])  # fmt: skip
@pytest.mark.parametrize("status", [400, 404, 500])
def test_a_model_without_eyes_is_named_as_such_at_once(message: str, status: int) -> None:
    error = told(message, status)
    assert not isinstance(error, NoAnswerError) and "takes no pictures" in str(error)


@pytest.mark.parametrize(("message", "most"), [
    ("Too many images provided. This model supports up to 5 images", "5"),
    ("Number of images should be less or equal than 3", "3"),
    ("Total number of images in the request (8) exceeds the maximum allowed (3).", "3"),
    ("You set image=4 (or defaulted to 1) in `--limit-mm-per-prompt`, but passed 8 image items", "4"),
    ("too many images and documents: 8 + 0 > 4", "4"),
    ("only 2 images are allowed per request", "2"),
    ("8 images exceed the limit of 6", "6"),
    ("The request contains too many images", "N"),
])  # fmt: skip
def test_the_most_pictures_that_a_server_takes_are_read_from_its_message(message: str, most: str) -> None:
    setting = f"set 'flow: {{max_pictures: {most}}}'"
    assert f"8 pictures in one question are too many (HTTP 400: {message}); {setting}" in str(told(message))


@pytest.mark.parametrize("message", [
    "messages.0.content.1.image.source.base64: image exceeds 5 MB maximum: 5316852 bytes > 5242880 bytes",
    "The image size exceeds the limit",
    "Image is too large: 9000x9000 pixels",
])  # fmt: skip
def test_a_picture_that_is_too_large_is_no_question_of_their_number(message: str) -> None:
    error = str(told(message))
    assert "--longest-side" in error and "max_pictures" not in error


@pytest.mark.parametrize("message", [
    "Could not process image", "Invalid image data: cannot decode", "image format webp is not supported",
])  # fmt: skip
def test_one_picture_at_fault_costs_one_question(message: str) -> None:
    assert isinstance(told(message), NoAnswerError)


ANSWER = "* lit(a): True"


@pytest.mark.parametrize(("before", "after"), [
    ("<seed:think>* lit(a): False</seed:think>", ""),
    ('<think time="3">* lit(a): False</think>', ""),
    ("<reasoning>\n* lit(a): False\n</reasoning>\n", ""),
    ("<|channel|>analysis<|message|>* lit(a): False<|end|><|start|>assistant<|channel|>final<|message|>", "<|return|>"),
    ("analysisWe see no light.assistantfinal", ""),
    ("<|START_THINKING|>* lit(a): False<|END_THINKING|>", "<|im_end|>\n"),
    ("◁think▷* lit(a): False◁/think▷", ""),
    ("Here is my thought process: * lit(a): False\nHere is my response:\n", ""),
])  # fmt: skip
def test_thinking_of_many_templates_is_no_answer(before: str, after: str) -> None:
    assert spoken(before + ANSWER + after) == (ANSWER, False)
    begun = before.partition("False")[0]
    if "False" in before:
        assert spoken(begun) == ("", True), "cut short before the end"


def hidden(tokens: int, finish: str, text: str, **message: Any) -> Callable[[dict[str, Any]], Reply]:
    """A model that thinks ``tokens`` and shows it oddly: by ``finish`` and ``text`` when they are too many."""

    def reply(body: dict[str, Any]) -> Reply:
        limit = body["max_tokens"]
        if limit < tokens + 40:
            return said(text, finish, limit, message=message)
        return said(ANSWER, tokens=tokens + 60)

    return reply


@pytest.mark.parametrize(("finish", "text", "message"), [
    ("stop", "", {"reasoning": "Let me look."}),
    ("stop", "", {}),
    ("length", "* lit(", {"reasoning_content": "Let me look."}),
    ("length", "* lit(", {}),
    ("eos", " \n", {}),
])  # fmt: skip
def test_thoughts_that_eat_the_budget_are_given_room_however_a_server_shows_it(
    finish: str, text: str, message: dict[str, Any]
) -> None:
    with running(Scripted(hidden(3000, finish, text, **message))) as server:
        vlm = asked_of(server)
        assert [vlm.answer(replace(LABEL, sample=n)).text for n in range(3)] == [ANSWER] * 3
        assert len(server.asked) == 4


def test_a_long_answer_that_is_cut_is_no_thought() -> None:
    with running(Scripted(lambda body: said("* lit(a): True. It shines.\n" * 60, "length", 400))) as server:
        assert asked_of(server).answer(LABEL).text and len(server.asked) == 1


def test_an_answer_of_thinking_alone_says_so() -> None:
    only = Scripted(lambda body: said(None, message={"reasoning_content": ANSWER}))
    with running(only) as server, pytest.raises(NoAnswerError, match=r"holds thinking and no text.*--reasoning-parser"):
        asked_of(server).answer(LABEL)
