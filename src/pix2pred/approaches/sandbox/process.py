"""Our side of the sandbox: starts a confined process per classifier, and takes nothing from it but zeros and ones."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pix2pred.structs import Object
from pix2pred.structs.samplers import Features
from pix2pred.system.errors import Pix2predError

CHILD = Path(__file__).with_name("child.py")


class CodeError(ValueError):
    """A classifier that cannot be used: refused, failing, too slow or killed. The message says what it did."""


class SandboxError(Pix2predError, RuntimeError):
    """Code cannot be run safely on this system, so it is not run at all."""


@dataclass(frozen=True, slots=True)
class SandboxLimits:
    """What a classifier may use for all its queries together.

    ``steps`` (executed instructions) decide first and are the same on every machine; processor and wall seconds are
    the net below, for what does not count as steps.
    """

    steps: int = 2_000_000
    megabytes: int = 512
    cpu_seconds: int = 10
    wall_seconds: float = 120.0


def run_classifier(
    source: str,
    function: str,
    types: Sequence[str],
    scenes: Sequence[Features],
    queries: Sequence[tuple[int, tuple[Object, ...]]],
    limits: SandboxLimits = SandboxLimits(),
    child: Path = CHILD,
) -> tuple[bool, ...]:
    """The values of ``function``, defined in ``source``, for every (number of a scene, arguments).

    They depend on the scenes and the arguments alone. ``child`` is the program of the confined process.

    Raises ``CodeError`` for code that is refused or misbehaves, ``SandboxError`` where code cannot be confined.
    """
    job = {
        "source": source,
        "function": function,
        "types": list(types),
        "states": [_plain(scene) for scene in scenes],
        "queries": [(number, [o.prompt_name for o in objects]) for number, objects in queries],
        "steps": limits.steps,
        "megabytes": limits.megabytes,
        "cpu_seconds": limits.cpu_seconds,
    }
    answer = _exchange(child, json.dumps(job).encode(), len(queries) + 1000, limits.wall_seconds)
    kind, text = answer[:1], answer[1:]
    if kind == "U":
        raise SandboxError(f"code written by a model is not run: {text}")
    if kind == "V" and len(text) == len(queries) and set(text) <= {"0", "1"}:
        return tuple(c == "1" for c in text)
    if kind == "X":
        raise CodeError(" ".join(text.split())[:300])
    raise CodeError(f"gave no usable answer ({answer[:40]!r})")


def _plain(scene: Features) -> dict[str, tuple[list[str], dict[str, float]]]:
    """Objects by what prompts call them: their types from the most specific up, and their features by name."""
    plain = {}
    for thing, features in sorted(scene.items()):
        kinds = [kind.name for kind in thing.type.lineage]
        plain[thing.prompt_name] = (kinds, dict(zip(thing.type.features, features, strict=True)))
    return plain


def _exchange(child: Path, job: bytes, longest: int, wall_seconds: float) -> str:
    """Send the job and read at most ``longest`` bytes. Raises ``CodeError`` when the process was killed."""
    command = [sys.executable, "-P", "-s", "-S", "-B", str(child)]
    with subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={"PYTHONHASHSEED": "0"},
        cwd="/",
        close_fds=True,
        start_new_session=True,
    ) as process:
        assert process.stdin is not None and process.stdout is not None, "both are pipes"
        alarm = threading.Timer(wall_seconds, process.kill)
        alarm.start()
        try:
            try:
                process.stdin.write(job)
                process.stdin.close()
            except BrokenPipeError:
                pass  # it ended before it had read everything; its answer says why
            said = process.stdout.read(longest + 1)
            if len(said) > longest:
                process.kill()
                raise CodeError(f"wrote more than {longest} bytes")
            code = process.wait()
        finally:
            alarm.cancel()
            process.kill()
    if code < 0:
        raise CodeError(f"was killed ({signal.Signals(-code).name})")
    return said.decode("ascii", "replace")
