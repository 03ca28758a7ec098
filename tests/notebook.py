"""Runs the code cells of a notebook one after the other, as Jupyter does; also a program that writes what they print.

``python tests/notebook.py docs/quickstart.ipynb`` runs a notebook and stores the printed outputs in it.
"""

from __future__ import annotations

import ast
import contextlib
import io
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any


def printed(notebook: dict[str, Any]) -> Iterator[tuple[dict[str, Any], str]]:
    """Every code cell with what it prints, the value of a last expression included; figures show as nothing."""
    names: dict[str, Any] = {"__name__": "__main__"}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            tree = ast.parse("".join(cell["source"]))
            last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                exec(compile(tree, "cell", "exec"), names)
                if last is not None:
                    assert isinstance(last, ast.Expr)
                    value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
                    if value is not None and not hasattr(value, "_repr_png_"):
                        print(repr(value))
            yield cell, said.getvalue()


def main(path: Path) -> None:
    """Store what the cells print."""
    notebook = json.loads(path.read_text())
    for cell, text in printed(notebook):
        stream = {"name": "stdout", "output_type": "stream", "text": text.splitlines(keepends=True)}
        cell["outputs"] = [stream] if text else []
    path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
