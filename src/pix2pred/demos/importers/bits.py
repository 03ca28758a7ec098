"""States as bits and actions as numbers, as learners of action models exchange them: lines become a traces document."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pix2pred.demos.files.problems import FolderError, Problem

MOST_BYTES = 50_000_000
_BITS = re.compile(rb"[01](?:[ \t,;]*[01])*")
_ACTION = re.compile(rb"\d{1,9}")
_AROUND = b" \t\r[]()"
"""What may stand around a line, as lists and arrays are printed."""


@dataclass(frozen=True, slots=True)
class _Trace:
    """One trace: its states, and the action after each but the last; ``line`` is where it begins."""

    states: tuple[tuple[int, ...], ...]
    actions: tuple[int, ...]
    line: int


def traces_of_bits(file: Path) -> dict[str, Any]:
    """The traces document of ``file``: bits and numbers of actions in turn, one a line; an empty line ends a trace.

    Bit N becomes the predicate ``zN`` and action N the skill ``aN``, both without arguments. The goal of a trace are
    the bits that its actions set, or all bits of its last state when they set none. Raises ``FolderError`` with all
    lines that are wrong, and ``OSError``.
    """
    with file.open("rb") as opened:
        content = opened.read(MOST_BYTES + 1)
    if len(content) > MOST_BYTES:
        raise FolderError.about(file, f"has more than {MOST_BYTES:,} bytes")
    found: list[Problem] = []
    traces = [t for rows in _blocks(content) if (t := _trace(file, rows, found)) is not None]
    for trace in traces[1:]:
        if (width := len(trace.states[0])) != (first := len(traces[0].states[0])):
            found.append(Problem(file, trace.line, f"a state of {width} bits, where the first trace has {first}"))
    if not traces and not found:
        found.append(Problem(file, None, "holds no trace: bits, the number of an action, bits, each on a line"))
    if found:
        raise FolderError(found)
    return {
        "format": "pix2pred-traces",
        "version": 1,
        "types": [],
        "skills": [{"name": f"a{n}", "types": []} for n in sorted({a for t in traces for a in t.actions})],
        "predicates": [
            {"name": f"z{n}", "types": [], "source": "human", "kind": "given"} for n in range(len(traces[0].states[0]))
        ],
        "demos": [_demo(f"trace-{n}", trace) for n, trace in enumerate(traces)],
    }


def _blocks(content: bytes) -> Iterator[list[tuple[int, bytes]]]:
    """The numbered lines of each trace, without the empty ones between."""
    rows: list[tuple[int, bytes]] = []
    for number, line in enumerate(content.removeprefix(b"\xef\xbb\xbf").splitlines(), start=1):
        if text := line.strip(_AROUND):
            rows.append((number, text))
        elif rows:
            yield rows
            rows = []
    if rows:
        yield rows


def _trace(file: Path, rows: Sequence[tuple[int, bytes]], found: list[Problem]) -> _Trace | None:
    """The trace in ``rows``; None, with its problems in ``found``, when something is wrong."""
    before = len(found)
    for i, (number, text) in enumerate(rows):
        pattern, what = (_ACTION, "the number of an action") if i % 2 else (_BITS, "the bits of a state, 0 and 1")
        if not pattern.fullmatch(text):
            shown = text[:40].decode("utf-8", errors="replace")
            found.append(Problem(file, number, f"expected {what}, found {shown!r}"))
    if len(rows) % 2 == 0 or len(rows) < 3:
        found.append(Problem(file, rows[-1][0], "a trace has an action between two states, and ends with a state"))
    if len(found) > before:
        return None
    states = tuple(tuple(int(c) for c in text.decode() if c in "01") for _, text in rows[::2])
    for state, (number, _) in zip(states, rows[::2], strict=True):
        if len(state) != len(states[0]):
            found.append(Problem(file, number, f"a state of {len(state)} bits, where the first has {len(states[0])}"))
    return _Trace(states, tuple(int(text) for _, text in rows[1::2]), rows[0][0]) if len(found) == before else None


def _demo(name: str, trace: _Trace) -> dict[str, Any]:
    first, last = trace.states[0], trace.states[-1]
    gained = [n for n, bit in enumerate(last) if bit and not first[n]]
    return {
        "name": name,
        "objects": {},
        "goal": [[f"z{n}"] for n in gained or [n for n, bit in enumerate(last) if bit]],
        "actions": [[f"a{a}"] for a in trace.actions],
        "states": [[[f"z{n}"] for n, bit in enumerate(state) if bit] for state in trace.states],
    }
