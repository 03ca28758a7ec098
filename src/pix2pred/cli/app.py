"""The program: registers the verbs, and turns errors into one clear message and an exit code.

Exit codes: 0 done, 1 the job failed (no plan, not solved), 2 bad input, 130 interrupted, 143 terminated.
"""

from __future__ import annotations

import signal
import sys
from collections.abc import Sequence
from types import FrameType

from cyclopts import App, CycloptsError
from pydantic import ValidationError

from pix2pred import __version__
from pix2pred.cli.answers import answers
from pix2pred.cli.bench import bench
from pix2pred.cli.data import check, generate, schema
from pix2pred.cli.demo import demo
from pix2pred.cli.doctor import doctor
from pix2pred.cli.imports import imports
from pix2pred.cli.init import init
from pix2pred.cli.learn import learn
from pix2pred.cli.plan import plan
from pix2pred.cli.plan_pddl import plan_pddl
from pix2pred.cli.review import review
from pix2pred.cli.select import select
from pix2pred.cli.solve import solve
from pix2pred.system.errors import Pix2predError, StoppedError

app = App(
    name="pix2pred",
    version=__version__,
    suppress_keyboard_interrupt=False,
    help="Learn symbolic world models from image demonstrations, and solve new tasks with them.",
)
for _verb in (init, demo, generate, check, schema, learn, review, solve, plan, select, plan_pddl, doctor):
    app.command(_verb)
app.command(answers)
app.command(imports)
app.command(bench)


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command line and exit. SIGTERM ends it like Ctrl-C: what was begun is cleaned up; a second one kills."""
    signal.signal(signal.SIGTERM, _terminate)
    sys.exit(run(argv))


def _terminate(number: int, _frame: FrameType | None) -> None:
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    sys.exit(128 + number)


def run(argv: Sequence[str] | None = None) -> int:
    """Run the command line; gives the exit code."""
    try:
        result = app(argv, exit_on_error=False, print_error=False, result_action="return_value")
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
    except OSError as error:
        return _complain(f"{error.filename or ''}: {error.strerror or error}".lstrip(": "))
    return result if isinstance(result, int) else 0


def _in_options(error: CycloptsError) -> str:
    """The error in the words of the command line: settings are checked by pydantic, which names fields."""
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
