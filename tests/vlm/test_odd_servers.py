"""Servers that answer as public bug reports describe: thinking, refusing parameters, taking no pictures, and worse."""

from __future__ import annotations

import gzip
import json
import random
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from extras import need
from pix2pred.predicates import ProposalSettings, propose
from pix2pred.predicates.proposing.propose import EmptyProposalError, TooManyPicturesError, parts_of
from pix2pred.registry import REGISTRY
from pix2pred.vlm import VLM, Answer, Finish, FlowSettings, NoAnswerError, Purpose, Request, Spent, VLMError
from pix2pred.vlm.checkup import MOST_QUESTIONS, Trait, check
from pix2pred.vlm.control.flow import FlowVLM, TransientError
from pix2pred.vlm.control.guard import BeyondEstimateError, Expected, GuardVLM
from pix2pred.vlm.hosted.failures import _blotted
from pix2pred.vlm.hosted.http import MOST_BYTES
from pix2pred.vlm.hosted.spoken import spoken
from pix2pred.vlm.model_spec import ModelNameError, Spending
from predicates.scripted import ScriptedVLM, demo
from vlm.fault_server import FaultServer
from vlm.odd_server import Reply, Scripted, refused, running, said, thinking
from vlm.real_servers import view

FAST = FlowSettings(first_pause=0.0, longest_pause=0.0, tries=4, timeout=60.0)
QUESTION = Request(Purpose.LABEL, ("Is it lit?", view(20, 0), "\nPredicates:\nlit(a)"), 400)


def asked_of(server: FaultServer, flow: FlowSettings = FAST) -> VLM:
    return REGISTRY.vlm(f"openai-compatible:tiny@{server.url}", None, flow)


@pytest.mark.parametrize("tokens", [1500, 6000, 16_000])
def test_a_model_that_thinks_gets_room_for_it_once_and_for_all(tokens: int) -> None:
    with running(Scripted(thinking(tokens))) as server:
        vlm = asked_of(server)
        answers = [vlm.answer(replace(QUESTION, sample=n)) for n in range(5)]
        assert all(a.text.startswith("* lit(a): True") for a in answers)
        assert len(server.asked) == 6, "one question was asked twice"
        assert answers[0].spent.output_tokens == 400 + tokens + 60, "what was of no use was paid for too"


@pytest.mark.parametrize("tokens", [20_000, 50_000, 1_000_000])
def test_a_model_that_only_thinks_ends_the_run_with_the_cause(tokens: int) -> None:
    with running(Scripted(thinking(tokens))) as server:
        with pytest.raises(VLMError, match=r"cut short by the token budget.*flow: \{thinking: N\}") as caught:
            asked_of(server).answer(QUESTION)
        assert not isinstance(caught.value, NoAnswerError) and len(server.asked) == 2
        told = asked_of(server, FAST.model_copy(update={"thinking": 2_000_000}))
        assert told.answer(QUESTION).text, "with a budget of its own"


def test_a_single_question_that_is_thought_about_for_ever_is_a_gap() -> None:
    def reply(body: dict[str, Any]) -> Reply:
        return said("", "length") if body["seed"] == 1000 else said("lit(a): True")

    with running(Scripted(reply)) as server:
        vlm = asked_of(server)
        assert vlm.answer(QUESTION).text
        with pytest.raises(NoAnswerError, match="cut short by the token budget before it said anything"):
            vlm.answer(replace(QUESTION, sample=1))


def test_room_for_thinking_that_the_model_does_not_allow_is_halved() -> None:
    def reply(body: dict[str, Any]) -> Reply:
        if body["max_tokens"] > 8192:
            return refused(f"max_tokens is too large: {body['max_tokens']}. This model supports at most 8192")
        return thinking(3000)(body)

    with running(Scripted(reply)) as server:
        assert asked_of(server).answer(QUESTION).text
        assert [b["max_tokens"] for b in server.asked] == [400, 16784, 8592, 4496]


def test_settings_of_flow_reach_the_server() -> None:
    flow = FAST.model_copy(update={"output_tokens": 1000, "thinking": 500, "temperature": None})
    with running(Scripted(lambda body: said("lit(a): True"))) as server:
        asked_of(server, flow).answer(QUESTION)
        (body,) = server.asked
        assert body["max_tokens"] == 1500 and "temperature" not in body


@pytest.mark.parametrize("model", ["o4-mini", "gpt-5-mini"])
def test_known_thinkers_have_room_from_the_first_question(model: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", "sk-not-a-key-000000")
    with running(Scripted(thinking(3000))) as server:
        monkeypatch.setenv("OPENAI_BASE_URL", server.url)
        assert REGISTRY.vlm(f"openai:{model}", None, FAST).answer(QUESTION).text
        assert len(server.asked) == 1
    rates = REGISTRY.model_spec(f"openai:{model}").rates
    assert rates is not None and rates.thinking_tokens() >= 3000, "and the dry run counts it"


@need("google.genai", extra="google")
@pytest.mark.parametrize(("model", "sent"), [("gemini-2.5-pro", 8192), ("gemini-2.0-flash", None)])
def test_google_is_told_how_much_to_think(model: str, sent: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
    def reply(body: dict[str, Any]) -> Reply:
        content = {"role": "model", "parts": [{"text": "lit(a): True"}]}
        usage = {"promptTokenCount": 9, "candidatesTokenCount": 3}
        return 200, {"candidates": [{"content": content, "finishReason": "STOP", "index": 0}], "usageMetadata": usage}

    monkeypatch.setenv("GOOGLE_API_KEY", "not-a-key-000000")
    with running(Scripted(reply)) as server:
        monkeypatch.setenv("GOOGLE_GEMINI_BASE_URL", server.url.removesuffix("/v1"))
        REGISTRY.vlm(f"google:{model}", None, FAST).answer(QUESTION)
        (body,) = server.asked
    made = body["generationConfig"]
    assert made["maxOutputTokens"] == 400 + (sent or 0)
    assert made.get("thinkingConfig", {}).get("thinking_budget") == sent, "protocol buffers take both spellings"


@pytest.mark.parametrize(
    ("text", "answer", "unfinished"),
    [
        ("Maybe wet(a)?\n</think>\n\nlit(a): True", "lit(a): True", False),
        ("<think>lit(a): False</think>lit(a): True", "lit(a): True", False),
        ("<think>one</think><think>two</think> lit(a): True", "lit(a): True", False),
        ("<THINKING>\nno\n</THINKING>\nlit(a): True", "lit(a): True", False),
        ("[THINK]no[/THINK]lit(a): True", "lit(a): True", False),
        ("<think>\nlit(a): False. But wait, the", "", True),
        ("lit(a): True\n<think>\nor is", "lit(a): True", True),
        ("no</think>\n<think>lit(a): False", "", True),
        ("lit(a): True \ud83d", "lit(a): True \N{REPLACEMENT CHARACTER}", False),
        ("I think: lit(a): True", "I think: lit(a): True", False),
    ],
)
def test_thinking_is_no_answer(text: str, answer: str, unfinished: bool) -> None:
    assert spoken(text) == (answer, unfinished)


def test_thinking_that_never_ends_is_an_answer_cut_short() -> None:
    unfinished = Scripted(lambda body: said("<think>\nlit(a): True\nBut wait"))
    with running(unfinished) as server, pytest.raises(VLMError, match="cut short"):
        asked_of(server).answer(QUESTION)
    with running(Scripted(lambda body: said("no\n</think>\n\nlit(a): True"))) as server:
        assert asked_of(server).answer(QUESTION).text == "lit(a): True"


def litellm(body: dict[str, Any]) -> Reply:
    if body.get("temperature", 1) != 1:
        return refused("litellm.UnsupportedParamsError: gpt-5 models don't support temperature=0.0. Only temperature=1")
    if "max_tokens" in body:
        return refused("Unsupported parameter: 'max_tokens' is not supported. Use 'max_completion_tokens' instead.")
    return said("lit(a): True")


def without(*names: str) -> Callable[[dict[str, Any]], Reply]:
    def reply(body: dict[str, Any]) -> Reply:
        found = next((name for name in names if name in body), None)
        return refused(f"Extra inputs are not permitted: {found}", 422) if found else said("lit(a): True")

    return reply


@pytest.mark.parametrize(
    ("reply", "most"),
    [(litellm, 3), (without("seed"), 2), (without("temperature", "seed"), 3), (without("logprobs", "top_logprobs"), 2),
     (without("response_format"), 2)],
    ids=["litellm", "seed", "two", "logprobs", "schema"],
)  # fmt: skip
def test_what_a_server_does_not_take_is_left_out_and_remembered(
    reply: Callable[[dict[str, Any]], Reply], most: int
) -> None:
    schema = json.dumps({"type": "object", "properties": {}, "additionalProperties": False, "required": []})
    question = replace(QUESTION, logprobs=True, schema=schema)
    with running(Scripted(reply)) as server:
        vlm = asked_of(server)
        assert vlm.answer(question).text == "lit(a): True"
        assert len(server.asked) == most
        assert vlm.answer(replace(question, sample=1)).text and len(server.asked) == most + 1


LASTING = {
    "no projector": refused("image input is not supported - hint: you may need to provide the mmproj", 500),
    "text only": refused("This model does not support image input", 400),
    "not multimodal": refused("tiny is not a multimodal model", 400),
    "memory": refused("model requires more system memory (12.6 GiB) than is available (7.4 GiB)", 500),
    "cuda": refused("CUDA out of memory. Tried to allocate 2.00 GiB", 500),
    "loading": refused("failed to load model 'tiny'", 500),
    "one picture": refused("At most 1 image(s) may be provided in one request."),
    "five pictures": refused("Too many images provided (8). This model supports up to 5 images"),
    "proxy": (413, b"<html><head><title>413 Request Entity Too Large</title></head><body></body></html>"),
    "router": refused("request entity too large", 413),
    "large pictures": refused("image dimensions exceed max allowed size for many-image requests: 2000 pixels"),
}


@pytest.mark.parametrize("what", LASTING)
def test_causes_that_time_does_not_mend_end_the_run_at_once(what: str) -> None:
    with running(Scripted(lambda body: LASTING[what])) as server:
        with pytest.raises(VLMError) as caught:
            asked_of(server).answer(QUESTION)
        assert not isinstance(caught.value, NoAnswerError | TransientError) and len(server.asked) == 1
        if "picture" in what:
            assert "1 pictures in one question" in str(caught.value)
            assert ("max_pictures" in str(caught.value)) == (what != "one picture")
        assert "<" not in str(caught.value)


UNUSUAL: dict[str, dict[str, Any]] = {
    "null id": {"id": None},
    "text for created": {"created": "2026-01-01"},
    "huge created": {"created": 10**30},
    "usage as a list": {"usage": [1, 2]},
    "usage of text": {"usage": {"prompt_tokens": "many"}},
    "no object": {"object": 7},
    "no model": {"model": None},
    "more fields": {"x_groq": {"id": [None]}, "prompt_logprobs": None},
    "text for a number": {
        "choices": [
            {"index": "0", "message": {"role": "assistant", "content": "lit(a): True"}, "finish_reason": "stop"}
        ]
    },
    "little": {"choices": [{"message": {"role": "assistant", "content": "lit(a): True"}}], "id": None, "usage": None},
}


@pytest.mark.parametrize("what", UNUSUAL)
def test_bodies_that_are_good_but_unusual_are_read(what: str) -> None:
    with running(Scripted(lambda body: said("lit(a): True", **UNUSUAL[what]))) as server:
        assert asked_of(server).answer(QUESTION).text == "lit(a): True"
        assert len(server.asked) == 1


@pytest.mark.parametrize("finish", ["eos", None, "guardrail_intervened", "end_turn", ""])
def test_unknown_reasons_to_finish_mean_that_the_answer_is_whole(finish: str | None) -> None:
    with running(Scripted(lambda body: said("lit(a): True", finish))) as server:
        answer = asked_of(server).answer(QUESTION)
    assert (answer.text, answer.finish) == ("lit(a): True", Finish.COMPLETE)


PAGE = b"<!DOCTYPE html><html><body><h1>Sign in</h1></body></html>"
NO_DOCUMENTS = {"a web page": PAGE, "an empty answer": b"", "no JSON": b"data: {}\n\ndata: [DONE]\n\n"}


@pytest.mark.parametrize("what", NO_DOCUMENTS)
def test_a_good_status_without_an_answer_is_named_and_ends_the_run_where_nothing_else_came(what: str) -> None:
    with running(Scripted(lambda body: (200, NO_DOCUMENTS[what]))) as server:
        with pytest.raises(VLMError, match=f"answers with {what}, as a log-in page.*is the address right"):
            asked_of(server).answer(QUESTION)
        assert len(server.asked) == 4


def test_a_page_between_answers_is_passed_over() -> None:
    replies = iter([said("lit(a): True"), (200, PAGE), (200, b""), said("lit(a): False")])
    with running(Scripted(lambda body: next(replies))) as server:
        vlm = asked_of(server)
        assert [vlm.answer(replace(QUESTION, sample=n)).text for n in (0, 1)] == ["lit(a): True", "lit(a): False"]


@pytest.mark.parametrize("status", [301, 302, 307, 308])
def test_questions_are_never_sent_where_a_server_points_to(status: int) -> None:
    place = {"location": "https://login.example.invalid/sso?key=1"}
    with running(Scripted(lambda body: (status, b""), place)) as server:
        with pytest.raises(
            VLMError, match=r"elsewhere, to https://login.example.invalid/sso, where they were not sent"
        ):
            asked_of(server).answer(QUESTION)
        assert len(server.asked) == 1


@pytest.mark.parametrize(("location", "told"), [
    ("/v2/chat?key=1", r"to http://127\.0\.0\.1:\d+/v2/chat, where"),
    ("//elsewhere.invalid/v1#top", "to http://elsewhere.invalid/v1, where"),
    ("http://x:port/y?key=1", "to http://x:port/y, where"),
    ("", "to nowhere, where"),
])  # fmt: skip
def test_where_a_server_points_to_is_named_whole(location: str, told: str) -> None:
    with (
        running(Scripted(lambda body: (307, b""), {"location": location})) as server,
        pytest.raises(VLMError, match=told),
    ):
        asked_of(server).answer(QUESTION)


@pytest.mark.parametrize(("message", "status", "told"), [
    ("Your credit balance is too low to access the API.", 400, "quota or credit is used up"),
    ("Key limit exceeded (total limit). Manage it using https://x/keys", 403, "quota or credit is used up"),
    ("Insufficient credits. Add more at https://x", 402, "quota or credit is used up"),
    ("m is not a valid model ID", 400, "knows no such model"),
    ("Invalid model name passed in model=m", 400, "knows no such model"),
    ("model 'm' not found, try pulling it first", 500, "knows no such model"),
])  # fmt: skip
def test_an_empty_account_and_an_unknown_model_end_the_run_at_once(message: str, status: int, told: str) -> None:
    with running(Scripted(lambda body: refused(message, status))) as server:
        with pytest.raises(VLMError, match=told) as caught:
            asked_of(server).answer(QUESTION)
        assert not isinstance(caught.value, NoAnswerError) and len(server.asked) == 1


def test_an_answer_that_proposes_nothing_is_shown() -> None:
    with (
        running(Scripted(lambda body: said("I'm sorry, I can't assist with that."))) as server,
        pytest.raises(EmptyProposalError, match=r"no atom in the answer: I'm sorry, I can't assist"),
    ):
        propose([demo()], asked_of(server), ProposalSettings())


@pytest.mark.parametrize("mistake", [
    TypeError("send() got an unexpected keyword argument 'x'"), AttributeError("no 'y'"), KeyError("z"),
    ImportError("cannot import name 'w'"),
])  # fmt: skip
def test_a_mistake_in_a_program_ends_the_run_at_once_and_is_named(
    mistake: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried = []

    async def send(*args: object, **settings: object) -> None:
        tried.append(args)
        raise mistake

    monkeypatch.setattr("pydantic_ai.direct.model_request", send)
    with (
        running(Scripted(lambda body: said("lit(a): True"))) as server,
        pytest.raises(
            VLMError, match=f"a fault in this program .*{type(mistake).__name__} in test_odd_servers.py, line"
        ),
    ):
        asked_of(server).answer(QUESTION)
    assert len(tried) == 1


def test_a_body_that_confuses_a_library_is_asked_for_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """The server answered, so that what is wrong may be the answer."""
    from pydantic_ai import direct

    sent, failed = direct.model_request, list[Any]()

    async def send(*args: Any, **settings: Any) -> Any:
        response = await sent(*args, **settings)
        if not failed:
            failed.append(response)
            raise TypeError("'NoneType' object is not iterable")
        return response

    monkeypatch.setattr("pydantic_ai.direct.model_request", send)
    with running(Scripted(lambda body: said("lit(a): True"))) as server:
        assert asked_of(server).answer(QUESTION).text == "lit(a): True"
        assert len(server.asked) == 2


@pytest.mark.parametrize("packed", [False, True])
def test_a_body_without_an_end_is_not_read_to_the_end(packed: bool) -> None:
    content = b" " * (MOST_BYTES + 1)
    headers = {"content-encoding": "gzip"} if packed else {}
    body = gzip.compress(content) if packed else content
    with running(Scripted(lambda _: (200, body), headers)) as server:
        with pytest.raises(NoAnswerError, match="larger than any answer"):
            asked_of(server).answer(QUESTION)
        assert len(server.asked) == 1


def test_a_packed_answer_is_read() -> None:
    body = gzip.compress(json.dumps(said("lit(a): True")[1]).encode())
    with running(Scripted(lambda _: (200, body), {"content-encoding": "gzip"})) as server:
        assert asked_of(server).answer(QUESTION).text == "lit(a): True"


def test_what_a_server_says_cannot_command_the_terminal_nor_tell_the_key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PIX2PRED_API_KEY", "secret-0123456789-end\r\n")
    said_it = "\x1b]0;owned\x07no\u202e: Bearer secret-0123456789-end, and 0123456789-end"
    with running(Scripted(lambda body: refused(said_it))) as server, pytest.raises(NoAnswerError) as caught:
        asked_of(server).answer(QUESTION)
    assert str(caught.value).isprintable() and "0123456789" not in str(caught.value)


def test_blotting_out_a_key_takes_linear_time() -> None:
    steps = "x" * 3_000_000  # a quadratic pattern needs hours for this
    assert _blotted(steps, "secret-0123456789") == steps
    assert _blotted(f"a {steps}0123secret-0 b", "secret-0123456789") == "a [key] b"


@pytest.mark.parametrize("wait", ["1000000000", "Fri, 31 Dec 9999 23:59:59 GMT"])
def test_a_server_that_asks_to_wait_for_ever_ends_the_run(wait: str) -> None:
    busy = Scripted(lambda body: refused("busy", 429), {"retry-after": wait})
    with running(busy) as server, pytest.raises(VLMError, match=r"longer than 600 s.*max_wait.*goes on from there"):
        asked_of(server).answer(QUESTION)


class Costing:
    """A model whose every answer costs ``spent``."""

    name = "costing"

    def __init__(self, spent: Answer) -> None:
        self.spent = spent
        self.asked = 0

    def answer(self, request: Request) -> Answer:
        self.asked += 1
        return self.spent


@pytest.mark.parametrize(
    ("dollars", "tokens", "expected", "asked"),
    [
        (None, 60, Expected(10, 600, None), 30),  # three times as many questions
        (None, 3000, Expected(10, 600, None), 1),
        (0.05, 60, Expected(10, 600, 0.1), 6),
        (0.001, 3000, Expected(10, 600, 0.1), 30),  # dear in tokens, and cheap
    ],
)
def test_spending_beyond_the_dry_run_stops(dollars: float | None, tokens: int, expected: Expected, asked: int) -> None:
    model = Costing(Answer("x", spent=Spent(100, tokens, dollars)))
    guard = GuardVLM(model, lambda: expected, 3.0, lambda request: model.spent.spent)
    with pytest.raises(BeyondEstimateError, match="beyond_estimate"):
        for n in range(100):
            guard.answer(replace(QUESTION, sample=n))
    assert model.asked == asked


@pytest.mark.parametrize(("labels", "asked"), [(14, 15), (20, 1)])
def test_labels_beyond_the_limit_are_noticed_when_the_proposals_are_known(labels: int, asked: int) -> None:
    dry_runs = iter([Expected(6, 600, None), Expected(labels, 60 * labels, None)])
    model = Costing(Answer("x"))
    guard = GuardVLM(model, lambda: next(dry_runs), 3.0, lambda request: Spent())
    guard.answer(replace(QUESTION, purpose=Purpose.PROPOSE))
    with suppress(BeyondEstimateError):
        for n in range(labels):
            guard.answer(replace(QUESTION, sample=n))
    assert model.asked == asked


@pytest.mark.parametrize("most", [300, 1000, 6000])
def test_questions_that_together_could_pass_the_limit_go_one_by_one(most: int) -> None:
    model = Waiting(tokens=100)
    guard = GuardVLM(model, lambda: Expected(40, 1000, None), 3.0, lambda request: Spent(0, most))
    with ThreadPoolExecutor(8) as pool:
        done = [pool.submit(guard.answer, replace(QUESTION, sample=n)) for n in range(8)]
        for n in range(8):
            model.meet(min(8 - n, max(1, 3000 // most)))
        failed = [d.exception() for d in done]
    assert all(isinstance(error, BeyondEstimateError | None) for error in failed)
    assert model.most_at_once <= max(1, 3000 // most)


class Waiting:
    """A model that answers one question at a time, when told to."""

    name = "waiting"

    def __init__(self, tokens: int) -> None:
        self.most_at_once = 0
        self._tokens = tokens
        self._under_way = 0
        self._free = 0
        self._changed = threading.Condition()

    def answer(self, request: Request) -> Answer:
        with self._changed:
            self._under_way += 1
            self.most_at_once = max(self.most_at_once, self._under_way)
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._free > 0)
            self._free -= 1
            self._under_way -= 1
        return Answer("x", spent=Spent(0, self._tokens))

    def meet(self, most: int) -> None:
        """Let one question be answered, once one is under way; more than ``most`` must not be."""
        with self._changed:
            met = self._changed.wait_for(lambda: self._under_way > self._free, 120)
            at_once, self._free = self._under_way - self._free, self._free + (1 if met else 100)
            self._changed.notify_all()
        assert met and at_once <= most


@pytest.mark.parametrize("cost", [float("nan"), float("inf"), -1.0])
def test_amounts_that_are_none_are_refused(cost: float) -> None:
    with pytest.raises(ModelNameError, match="--max-cost"):
        Spending(None, cost)


def test_proposals_are_asked_for_in_parts_that_a_server_takes() -> None:
    one = demo(actions=4)
    assert [list(p) for p in parts_of(one, None)] == [[0, 1, 2, 3, 4]]
    assert [list(p) for p in parts_of(one, 5)] == [[0, 1, 2, 3, 4]]
    assert [list(p) for p in parts_of(one, 3)] == [[0, 1, 2], [2, 3, 4]]
    assert [list(p) for p in parts_of(one, 2)] == [[0, 1], [1, 2], [2, 3], [3, 4]]
    vlm = ScriptedVLM(lambda request: f"n{request.views[0].state}(p1)\nboth(p1)")
    (proposal,) = propose([one], vlm, ProposalSettings(), max_pictures=3)
    assert [a.name for a in proposal.accepted] == ["n0", "both", "n2"]
    assert [len(r.views) for r in vlm.asked] == [3, 3]
    with pytest.raises(TooManyPicturesError, match=r"flow: \{max_pictures: 1\}"):
        list(parts_of(one, 1))


def test_a_waiting_time_is_told(caplog: pytest.LogCaptureFixture) -> None:
    flowing = FlowVLM(Costing(Answer("x")), FAST, clock=lambda: 0.0)
    flowing.hold(45.0)
    assert "the server asks to wait 45 s" in caplog.text


@pytest.mark.parametrize(("pictures", "counted", "told"), [
    (0, 2048, True), (1, 2048, True), (3, 4095, True), (2, 5000, False), (1, 9000, False), (1, 0, False),
])  # fmt: skip
def test_a_server_that_cuts_questions_silently_is_told_of_once(
    caplog: pytest.LogCaptureFixture, pictures: int, counted: int, told: bool
) -> None:
    """By its own count of tokens; a server that counts nothing says nothing."""
    usage = {"prompt_tokens": counted, "completion_tokens": 3, "total_tokens": counted + 3}
    long = replace(QUESTION, parts=("word " * 5000, *(view(20, n) for n in range(pictures))), about="d1, state 3")
    with running(Scripted(lambda body: said("lit(a): True", usage=usage))) as server:
        vlm = asked_of(server)
        for n in range(3):
            assert vlm.answer(replace(long, sample=n)).text == "lit(a): True"
    assert len([r for r in caplog.records if "cuts questions silently" in r.getMessage()]) == told
    assert f"d1, state 3 has 25000 characters and {pictures} pictures" in caplog.text or not told


def test_mutated_servers_never_hang_or_crash(tmp_path: Path) -> None:
    rng = random.Random(3)
    good = json.dumps(said("lit(a): True")[1])

    def reply(body: dict[str, Any]) -> Reply:
        place = rng.randrange(len(good))
        return rng.choice((200, 200, 400, 500)), (
            good[:place] + rng.choice('{}[]",:0\x00') + good[place + 1 :]
        ).encode()

    with running(Scripted(reply)) as server:
        vlm = asked_of(server, FAST.model_copy(update={"unusable_in_a_row": 1000, "tries": 1}))
        for n in range(40):
            try:
                vlm.answer(replace(QUESTION, sample=n))
            except VLMError as error:
                assert str(error).isprintable()


def traits(server: FaultServer) -> dict[str, Trait]:
    views = [view(20, 0), view(220, 1)]
    return {trait.what: trait for trait in check(asked_of(server), views)}


def test_a_check_up_of_a_good_server_asks_six_questions_at_most() -> None:
    with running(Scripted(lambda body: said("heliotrope: red, then blue"))) as server:
        found = traits(server)
        assert len(server.asked) <= MOST_QUESTIONS and all(trait.ok for trait in found.values())


def cutting(body: dict[str, Any]) -> Reply:
    status, document = said("I do not know")
    document["usage"]["prompt_tokens"] = 2048
    return status, document


def five_pictures(body: dict[str, Any]) -> Reply:
    shown = sum(part["type"] == "image_url" for part in body["messages"][0]["content"])
    return refused(f"Too many images provided ({shown}). Up to 5 images are supported") if shown > 5 else said("red")


FINDINGS: dict[str, tuple[Callable[[dict[str, Any]], Reply], str, str]] = {
    "thinking": (thinking(3000), "thinks", "flow: {thinking: "),
    "five pictures": (five_pictures, "8 pictures", "max_pictures"),
    "cut prompts": (cutting, "long questions", "longer context"),
    "no pictures": (lambda body: LASTING["no projector"], "answers", ""),
    "temperature": (litellm, "answers", ""),
}


@pytest.mark.parametrize("what", FINDINGS)
def test_a_check_up_finds_what_is_odd_and_says_which_setting_follows(what: str) -> None:
    reply, trait, setting = FINDINGS[what]
    with running(Scripted(reply)) as server:
        found = traits(server)
        assert setting in found[trait].setting
        assert found[trait].ok == (what in ("thinking", "temperature"))
        assert len(server.asked) <= MOST_QUESTIONS + 3, "each parameter that is left out costs a refused request more"
