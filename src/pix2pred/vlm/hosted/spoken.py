"""What a model says, apart from what it thinks: many servers leave the thinking in the text."""

from __future__ import annotations

import re

_KINDS = r"(?:\w+:)?(?:think(?:ing)?|thoughts?|reasoning|reflection|analysis|scratchpad)"
_OPENED = re.compile(
    rf"<{_KINDS}(?: [^<>]{{0,80}})?>|\[THINK\]|◁think▷|<\|(?:begin_of_thought|start_thinking|thinking)\|>"
    r"|<\|channel\|>(?!final)[^<\n]{0,80}(?:<\|message\|>|$)|\A\s*analysis(?=[A-Z*])"
    r"|^\W*here(?:'s|’s| is) my (?:thought|thinking|reasoning) process:",
    re.I | re.M,
)
_CLOSED = re.compile(
    rf"</{_KINDS}>|\[/THINK\]|◁/think▷|<\|(?:end_of_thought|end_thinking|/thinking)\|>"
    r"|<\|channel\|>final[^<\n]{0,80}<\|message\|>|assistantfinal"
    r"|^\W*here(?:'s|’s| is) my (?:response|answer|final answer):",
    re.I | re.M,
)
"""Tags; channels of the harmony format, also as they read when a server drops their marks; the sentences of Granite."""
_END_MARK = re.compile(r"(?:<\|(?:return|end|im_end|eot_id|end_of_text|endoftext|end_response)\|>\s*)+\Z", re.I)
_SURROGATE = re.compile("[\ud800-\udfff]")


def spoken(text: str) -> tuple[str, bool]:
    """The answer in ``text``, and whether it was cut short while the model still thought.

    All up to the last end of thinking is no answer, whether its beginning is marked or not. Thinking that begins
    after that and never ends takes the rest with it. Characters that no file can hold become question marks.
    """
    text = _END_MARK.sub("", _SURROGATE.sub("\N{REPLACEMENT CHARACTER}", text))
    ends = [match.end() for match in _CLOSED.finditer(text)]
    said = text[ends[-1] :].lstrip() if ends else text
    if begun := _OPENED.search(said):
        return said[: begun.start()].rstrip(), True
    return said, False
