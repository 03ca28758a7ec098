"""Finding out with a few cheap questions what a model and its server can do, and which settings follow from it.

Each question is one that a run would ask in some form; what goes wrong is told as a run would tell it, with the setting
that mends it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pix2pred.structs.views import View
from pix2pred.vlm.request import VLM, Answer, Finish, Purpose, Request, VLMError

MOST_QUESTIONS = 6
_TOKENS = 300
"""Budget of an answer of one sentence."""
_MANY_PICTURES = 8
"""Pictures of a proposal about a short demonstration."""
_LONG_TEXT = 24_000
"""Characters of a labelling question about a hundred atoms with its history: about 6,000 tokens, more than servers
with a context of 4,096 hold."""
_CHARACTERS_PER_TOKEN = 8
"""More than any tokenizer makes of one token of such text: fewer counted tokens mean that text was left out."""
_WORD = "heliotrope"


@dataclass(frozen=True, slots=True)
class Trait:
    """Something that was found out about a model.

    ``ok`` says whether it is as a run needs it, ``setting`` what to put into a project's settings, if anything.
    """

    what: str
    ok: bool
    detail: str
    setting: str = ""


def check(model: VLM, views: Sequence[View]) -> Iterator[Trait]:
    """Ask ``model`` at most ``MOST_QUESTIONS`` questions about ``views``, of which the first two are told apart.

    Ends after the first when the model cannot be asked at all.
    """
    try:
        first = model.answer(
            _request("Say in one short sentence which colour the square has in each picture.", views[:2])
        )
    except VLMError as error:
        yield Trait("answers", False, str(error))
        return
    yield _first(first)
    yield from _thinking(first)
    yield _pictures(model, views)
    yield _long(model, views, first)
    yield _structured(model, views)
    yield _probabilities(model, views)


def _request(text: str, views: Sequence[View], sample: int = 0, schema: str = "", *, logprobs: bool = False) -> Request:
    return Request(Purpose.DOCTOR, (text, *views), _TOKENS, sample=sample, schema=schema, logprobs=logprobs)


def _first(answer: Answer) -> Trait:
    said = " ".join(answer.text.split())[:160]
    spent = answer.spent
    took = f"{spent.seconds:.1f} s, {spent.input_tokens} + {spent.output_tokens} tokens"
    if answer.finish == Finish.REFUSED or not said:
        detail = f"answered two pictures with nothing of use ({answer.finish.value}: {said!r}; {took})"
        return Trait("answers", False, detail)
    return Trait("answers", True, f"two pictures (red, then blue): {said!r} ({took})")


def _thinking(answer: Answer) -> Iterator[Trait]:
    """Many more tokens than the answer has characters were thought."""
    thought = answer.spent.output_tokens - len(answer.text)
    if thought > 0:
        room = -(-2 * thought // 1024) * 1024
        detail = f"about {thought} tokens before a short answer; dry runs count them once they are set"
        yield Trait("thinks", True, detail, f"flow: {{thinking: {room}}}")


def _pictures(model: VLM, views: Sequence[View]) -> Trait:
    many = [views[n % len(views)] for n in range(_MANY_PICTURES)]
    try:
        model.answer(_request("How many pictures do you see? Answer with a number.", many, 1))
    except VLMError as error:
        return Trait(
            f"{_MANY_PICTURES} pictures", False, str(error), "flow: {max_pictures: 4}, or what the message says"
        )
    return Trait(f"{_MANY_PICTURES} pictures", True, "in one question")


def _long(model: VLM, views: Sequence[View], short: Answer) -> Trait:
    filling = "The lamp is still where it was and looks as it did before. "
    text = f"The password is {_WORD}.\n{filling * (_LONG_TEXT // len(filling))}\nWhich word is the password?"
    setting = "start the server with a longer context (Ollama: num_ctx, llama.cpp: --ctx-size, vLLM: --max-model-len)"
    try:
        answer = model.answer(_request(text, views[:1], 2))
    except VLMError as error:
        return Trait("long questions", False, str(error), setting)
    counted = answer.spent.input_tokens
    grown = counted - short.spent.input_tokens if counted else 0
    detail = f"{len(text)} characters, {counted} tokens by the server's count"
    if _WORD not in answer.text.lower() and counted and grown * _CHARACTERS_PER_TOKEN < len(text) // 2:
        return Trait("long questions", False, f"{detail}: the beginning of the question was cut off silently", setting)
    if answer.finish == Finish.TOO_LARGE:
        return Trait("long questions", False, f"{detail}: too long for the model", setting)
    return Trait("long questions", True, detail)


def _structured(model: VLM, views: Sequence[View]) -> Trait:
    fields = {"colour": {"type": "string"}}
    schema = {"type": "object", "properties": fields, "required": ["colour"], "additionalProperties": False}
    try:
        answer = model.answer(_request("Which colour has the square?", views[:1], 3, json.dumps(schema)))
        followed = isinstance(json.loads(answer.text), dict)
    except (VLMError, ValueError, RecursionError):
        followed = False
    detail = "keeps to a schema" if followed else "does not keep to a schema; prose is read as well"
    return Trait("structured answers", True, detail, "labels: {structured: true}" if followed else "")


def _probabilities(model: VLM, views: Sequence[View]) -> Trait:
    try:
        answer = model.answer(_request("Is the square red? Answer True or False.", views[:1], 4, logprobs=True))
    except VLMError as error:
        return Trait("probabilities", True, f"not given ({error})")
    detail = "given for every token" if answer.tokens else "not given"
    return Trait("probabilities", True, detail, "labels: {logprobs: true}" if answer.tokens else "")
