"""The program: registers the verbs, and turns errors into one clear message and an exit code.

Exit codes: 0 done, 1 the job failed (no plan, not solved), 2 bad input, 130 interrupted.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from cyclopts import App, CycloptsError

from pix2pred import __version__

app = App(
    name="pix2pred",
    version=__version__,
    help="Learn symbolic world models from image demonstrations, and solve new tasks with them.",
)
app.command(
    "pix2pred.cli.demo:demo",
    name="demo",
    help="Draw demonstrations, learn from them and solve unseen tasks, without a key.",
)
app.command(
    "pix2pred.cli.data:generate",
    name="generate",
    help="Write demonstrations and tasks of a simulated domain as a project folder.",
)
app.command(
    "pix2pred.cli.data:check", name="check", help="Report every problem of a project folder with file and line."
)
app.command(
    "pix2pred.cli.learn:learn", name="learn", help="Learn a world model from the demonstrations in a project folder."
)
app.command("pix2pred.cli.solve:solve", name="solve", help="Solve unseen tasks with a learned world model.")


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command line and exit."""
    sys.exit(run(argv))


def run(argv: Sequence[str] | None = None) -> int:
    """Run the command line; gives the exit code."""
    try:
        result = app(argv, exit_on_error=False, print_error=False, result_action="return_value")
    except CycloptsError as error:
        return _complain(str(error), "see 'pix2pred --help'")
    except KeyboardInterrupt:
        print("\ninterrupted; the same command goes on where this one stopped", file=sys.stderr)
        return 130
    except _bad_input() as error:
        return _complain(str(error))
    except OSError as error:
        return _complain(f"{error.filename or ''}: {error.strerror or error}".lstrip(": "))
    return result if isinstance(result, int) else 0


def _bad_input() -> tuple[type[Exception], ...]:
    """Errors that users can cause and put right."""
    from pix2pred.demos import FolderError
    from pix2pred.learning import TracesError
    from pix2pred.predicates import EmptyProposalError
    from pix2pred.predicates.expressions import ExpressionError
    from pix2pred.registry import RegistryError
    from pix2pred.run_folder import RunFolderError
    from pix2pred.structs import PictureError
    from pix2pred.structs.documents import UnknownNameError
    from pix2pred.structs.model_file import ModelFileError
    from pix2pred.vlm import VLMError

    return (
        EmptyProposalError, ExpressionError, FolderError, ModelFileError, PictureError, RegistryError,
        RunFolderError, TracesError, UnknownNameError, VLMError,
    )  # fmt: skip


def _complain(message: str, hint: str = "") -> int:
    print(f"pix2pred: {message}", file=sys.stderr)
    if hint:
        print(hint, file=sys.stderr)
    return 2
