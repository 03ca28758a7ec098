"""The program: registers the verbs, and turns errors into one clear message and an exit code.

Exit codes: 0 done, 1 the job failed (no plan, not solved), 2 bad input, 130 interrupted, 143 terminated.
"""

from __future__ import annotations

import ast
import errno
import os
import signal
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from cyclopts import App, CycloptsError, Parameter

from pix2pred import __version__
from pix2pred.system.errors import Pix2predError, StoppedError

if TYPE_CHECKING:
    from pix2pred.planners import Planners
    from pix2pred.registry import Registry

_VERBS = (
    "init:init",
    "demo:demo",
    "data:generate",
    "data:check",
    "data:schema",
    "learn:learn",
    "review:review",
    "mailbox:mailbox",
    "distil:distil",
    "solve:solve",
    "plan:plan",
    "select:select",
    "plan_pddl:plan_pddl",
    "validate:validate",
    "doctor:doctor",
    "mcp:mcp",
)
"""Module of this folder and function; a verb is imported when it is called, so that the others cost no time."""

_GROUPS = {
    "answers:answers": "Look into an answer store (a run folder, or the folder of --answers).",
    "imports:imports": "Bring photos, videos and robot data into a project as demonstrations.",
    "export:export": "Write projects and models in the forms of other places.",
    "robot:robot": "A simulated Spot, what to know before one moves, and tasks on one (extra spot).",
    "runs:runs": "List the runs in a folder, and compare two.",
    "bench:bench": "Run benchmark suites, see how far they are, report and compare them.",
}
"""Verbs that have verbs of their own, and their help."""

_NAMES = {"imports": "import"}
"""Verbs that cannot be called like their function."""


def _help(target: str) -> str:
    """The docstring of a verb, read from its source without running it."""
    module, _, function = target.partition(":")
    text = Path(__file__).with_name(f"{module}.py").read_text(encoding="utf-8")
    found = next(n for n in ast.parse(text).body if isinstance(n, ast.FunctionDef) and n.name == function)
    return ast.get_docstring(found) or ""


def _command_line() -> App:
    made = App(
        name="pix2pred",
        version=__version__,
        suppress_keyboard_interrupt=False,
        default_parameter=Parameter(negative=()),
        help="Learn symbolic world models from image demonstrations, and solve new tasks with them.",
    )
    made.register_install_completion_command(add_to_startup=False)
    for target, words in ({verb: _help(verb) for verb in _VERBS} | _GROUPS).items():
        name = target.rpartition(":")[2]
        made.command(f"pix2pred.cli.{target}", name=_NAMES.get(name, name.replace("_", "-")), help=words)
    return made


app = _command_line()


def main(argv: Sequence[str] | None = None, registry: Registry | None = None) -> None:
    """Run the command line and exit. SIGTERM ends it like Ctrl-C: what was begun is cleaned up; a second one kills."""
    signal.signal(signal.SIGTERM, _terminate)
    sys.exit(run(argv, registry))


def _terminate(number: int, _frame: FrameType | None) -> None:
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    sys.exit(128 + number)


def run(argv: Sequence[str] | None = None, registry: Registry | None = None) -> int:
    """Run the command line; gives the exit code. Names are looked up in ``registry``, by default what is installed."""
    try:
        command, bound, others = app.parse_args(argv, exit_on_error=False, print_error=False)
        passed = {name: registry or made() for name, made in _PASSED.items() if name in others}
        result = command(*bound.args, **bound.kwargs, **passed)
    except CycloptsError as error:
        return _complain(_in_options(error), "see 'pix2pred --help'")
    except KeyboardInterrupt:
        print("\ninterrupted; the same command goes on where this one stopped", file=sys.stderr)
        return 130
    except StoppedError as error:
        _complain(str(error))
        return 1
    except Pix2predError as error:
        return _complain(str(error))
    except BrokenPipeError:  # what reads the output has seen enough: there is nobody to tell
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        todo = _WHAT_TO_DO.get(error.errno or 0, "")
        return _complain(f"{error.filename or ''}: {error.strerror or error}{todo}".lstrip(": "))
    return result if isinstance(result, int) else 0


_WHAT_TO_DO = {
    errno.ENOSPC: "; make room and run the same command again: what was answered is stored",
    errno.EDQUOT: "; make room and run the same command again: what was answered is stored",
    errno.EROFS: "; name a folder that may be written to",
    errno.EACCES: "; it may not be read or written: change its rights, or name another folder",
}


def _registry() -> Registry:
    from pix2pred.registry import REGISTRY  # here, so that verbs that need none start faster

    return REGISTRY


def _planners() -> Planners:
    from pix2pred.planners import Planners

    return Planners()


_PASSED: dict[str, Callable[[], Planners]] = {"registry": _registry, "planners": _planners}
"""What a verb may take beside its options: everything that has a name, or the planners alone, which load faster."""


def _in_options(error: CycloptsError) -> str:
    """The error in the words of the command line: settings are checked by pydantic, which names fields."""
    from pydantic import ValidationError  # needed for an error alone, and slow to import

    cause = error.__cause__
    if not isinstance(cause, ValidationError):
        return str(error)
    first = cause.errors()[0]
    option = "-".join(str(part) for part in first["loc"]).replace("_", "-")
    return f"--{option}: {first['msg']}, found {first['input']!r}"


def _complain(message: str, hint: str = "") -> int:
    print(f"pix2pred: {message}", file=sys.stderr)
    if hint:
        print(hint, file=sys.stderr)
    return 2
