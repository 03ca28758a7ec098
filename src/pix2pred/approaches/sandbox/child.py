"""The confined process: reads a job, gives up its rights, runs the classifier, writes one character per query.

Run by path with ``python -P -s -S``, so it imports nothing of ours but its two neighbours. The answer is ``V`` and a 0
or 1 per query, ``X`` and what the code did wrong, or ``U`` and why nothing could be run.
"""

from __future__ import annotations

import builtins
import importlib.util
import json
import math
import os
import sys
from collections.abc import Callable, Iterable, Iterator, MutableSet
from types import CodeType, FrameType, ModuleType
from typing import Any

FILE = "<predicate>"
LONGEST_RANGE = 100_000
MAKE_SET, REMAINDER = "_set", "_remainder"
"""As in ``allow_list``, which is loaded later."""


class StepsExceeded(BaseException):
    """More steps than allowed: the same on every machine, unlike seconds."""


def neighbour(name: str) -> ModuleType:
    """A module beside this file."""
    spec = importlib.util.spec_from_file_location(name, os.path.join(os.path.dirname(__file__), f"{name}.py"))  # noqa: PTH118, PTH120
    assert spec is not None and spec.loader is not None, "the file is there"
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class ChildState:
    """What a classifier sees of a state."""

    __slots__ = ("_scene",)

    def __init__(self, scene: dict[str, list[Any]]) -> None:
        self._scene = scene

    def get(self, name: str, feature: str) -> float:
        """The value of a feature of an object. Raises ``KeyError`` for an unknown object or feature."""
        return float(self._scene[name][1][feature])

    def objects(self, kind: str) -> list[str]:
        """The names of all objects of a type, sub-types included, sorted."""
        return sorted(name for name, (kinds, _) in self._scene.items() if kind in kinds)


def counter(steps: int) -> Callable[[FrameType, str, Any], Any]:
    """A trace function that stops the code after ``steps`` instructions."""
    left = steps

    def trace(frame: FrameType, event: str, argument: Any) -> Any:
        nonlocal left
        if frame.f_code.co_filename != FILE:
            return None
        frame.f_trace_opcodes, frame.f_trace_lines = True, False  # a loop on one line has no line events
        left -= 1
        if left < 0:
            raise StepsExceeded
        return trace

    return trace


def short_range(*bounds: int) -> range:
    """A ``range`` that what runs in C, and thus takes no steps, cannot be kept busy with for long."""
    numbers = range(*bounds)
    if len(numbers) > LONGEST_RANGE:
        raise ValueError(f"a range of more than {LONGEST_RANGE} numbers")
    return numbers


class PlainSet(MutableSet[Any]):
    """A set in the order in which its elements were added: that of a real one may depend on addresses in memory."""

    def __init__(self, elements: Iterable[Any] = ()) -> None:
        self._elements = dict.fromkeys(elements)

    def __contains__(self, element: object) -> bool:
        return element in self._elements

    def __iter__(self) -> Iterator[Any]:
        return iter(self._elements)

    def __len__(self) -> int:
        return len(self._elements)

    def add(self, value: Any) -> None:
        """Add an element."""
        self._elements[value] = None

    def discard(self, value: Any) -> None:
        """Remove an element, if it is there."""
        self._elements.pop(value, None)


def plain_text(value: Any = "") -> str:
    """``str`` of text, numbers and truth values; that of a function or an object would hold its address in memory."""
    if value is not None and not isinstance(value, str | int | float):
        raise TypeError(f"the text of a {type(value).__name__} is not allowed")
    return str(value)


def remainder(left: Any, right: Any) -> Any:
    """``left % right`` of numbers; formatting text is not allowed."""
    if isinstance(left, str):
        raise TypeError("text cannot be formatted with %")
    return left % right


def namespace(job: dict[str, Any], names: tuple[str, ...], attributes: frozenset[str]) -> dict[str, Any]:
    """The globals of the code: harmless builtins, ``math``, and one name per type of object."""
    maths = type("math", (), {name: staticmethod(v) if callable(v) else v for name in attributes
                              if (v := getattr(math, name)) is not None})  # fmt: skip
    return {
        "__builtins__": {name: getattr(builtins, name) for name in names}
        | {"range": short_range, "set": PlainSet, "str": plain_text},
        MAKE_SET: PlainSet,
        REMAINDER: remainder,
        "math": maths,
        "Predicate": lambda name, types, classifier: classifier,
        **{kind: kind for kind in job["types"]},
    }


def values(job: dict[str, Any], code: CodeType, scope: dict[str, Any]) -> str:
    """Run the code and ask its classifier."""
    sys.settrace(counter(job["steps"]))
    exec(code, scope)
    classifier = scope[job["function"]]
    states = [ChildState(scene) for scene in job["states"]]
    said = []
    for number, names in job["queries"]:
        value = classifier(states[number], list(names))
        if not isinstance(value, bool | int | float):
            raise TypeError(f"the classifier gave a {type(value).__name__} instead of True or False")
        said.append("1" if value else "0")
    return "".join(said)


def answer(text: str) -> None:
    """Write the answer and end."""
    sys.settrace(None)
    os.write(1, text.encode("ascii", "replace"))
    os._exit(0)


def main() -> None:
    """The whole life of the process."""
    job = json.loads(sys.stdin.buffer.read())
    language, rights = neighbour("allow_list"), neighbour("confine")
    try:
        rights.confine(job["megabytes"], job["cpu_seconds"])
    except (rights.ConfinementError, OSError, ValueError) as error:
        answer(f"U{error}")
    sys.setrecursionlimit(500)
    try:
        tree = language.allowed(job["source"])
        code = compile(tree, FILE, "exec", dont_inherit=True)
        said = values(job, code, namespace(job, language.BUILTINS, language.MATH))
    except StepsExceeded:
        answer(f"Xmore than {job['steps']} steps")
    except BaseException as error:  # whatever the code raises is the code's fault
        sys.settrace(None)
        answer(f"X{type(error).__name__}: {str(error)[:200]}")
    else:
        answer(f"V{said}")


if __name__ == "__main__":
    main()
