"""What a model says, apart from what it thinks: many servers leave the thinking in the text."""

from __future__ import annotations

import re

_OPENED = re.compile(r"<(?:think|thinking|thought|reasoning)>|\[THINK\]|◁think▷", re.I)
_CLOSED = re.compile(r"</(?:think|thinking|thought|reasoning)>|\[/THINK\]|◁/think▷", re.I)
_SURROGATE = re.compile("[\ud800-\udfff]")


def spoken(text: str) -> tuple[str, bool]:
    """The answer in ``text``, and whether it was cut short while the model still thought.

    All up to the last end of thinking is no answer, whether its beginning is marked or not. Thinking that begins
    after that and never ends takes the rest with it. Characters that no file can hold become question marks.
    """
    text = _SURROGATE.sub("\N{REPLACEMENT CHARACTER}", text)
    ends = [match.end() for match in _CLOSED.finditer(text)]
    said = text[ends[-1] :].lstrip() if ends else text
    if begun := _OPENED.search(said):
        return said[: begun.start()].rstrip(), True
    return said, False
