"""The rooms of the design: imports point one way, files stay small, prompts and learning stay where they belong."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import pix2pred

ROOT = Path(pix2pred.__file__).parent
DOCS = Path(__file__).parents[1] / "docs"
MAY_IMPORT: dict[str, set[str]] = {
    "system": set(),
    "structs": {"system"},
    "images": {"structs"},
    "planning": {"structs"},
    "vlm": {"structs"},
    "domains": {"structs", "images"},
    "demos": {"structs", "images", "planning", "vlm"},
    "predicates": {"structs", "images", "planning", "vlm"},
    "learning": {"structs", "planning"},
    "recordings": {"structs"},
    "execution": {"structs", "images", "planning", "vlm", "demos", "predicates"},
    "robots": {"structs", "images", "planning", "vlm", "demos", "predicates", "execution"},
}
LOWER = set(MAY_IMPORT) - {"domains", "recordings", "robots"}
WITH_SETTINGS = LOWER | {"settings"}
ABOVE_THE_PIPELINE = WITH_SETTINGS | {"pipeline", "approaches"}
MAY_IMPORT |= {
    "settings": LOWER,
    "pipeline": WITH_SETTINGS,
    "runs": WITH_SETTINGS | {"pipeline", "robots"},
    "report": WITH_SETTINGS | {"pipeline", "runs"},
    "review": WITH_SETTINGS | {"pipeline", "runs", "report"},
    "planners": {"structs", "planning"},
    "gym_envs": {"structs", "registry"},
    "unified_planning_engine": {"structs", "planning", "planners"},
    "approaches": WITH_SETTINGS | {"pipeline"},
    "benchmark": ABOVE_THE_PIPELINE | {"runs"},
    "registry": LOWER | {"pipeline", "approaches", "domains", "planners"},
    "robots_by_name": {"structs", "execution", "registry", "robots"},
    "serving": WITH_SETTINGS | {"runs"},
    "api": WITH_SETTINGS | {"pipeline", "runs", "report", "registry"},
    "cli": ABOVE_THE_PIPELINE
    | {"runs", "api", "registry", "planners", "report", "review", "serving", "benchmark", "recordings", "robots"}
    | {"robots_by_name"},
    "__main__": {"cli"},
}
MAY_IMPORT = {room: allowed | {"system"} for room, allowed in MAY_IMPORT.items()}
MOST_FILES = 14
ONE_FILE_A_VERB = {"cli"}


def _sources() -> list[Path]:
    return sorted(ROOT.rglob("*.py"))


def _room(path: Path) -> str:
    parts = path.relative_to(ROOT).parts
    return parts[0].removesuffix(".py")


def _imports(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text())):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        yield from (n.split(".")[1] for n in names if n.startswith("pix2pred.") and n != "pix2pred.__version__")


@pytest.mark.parametrize("path", _sources(), ids=lambda p: str(p.relative_to(ROOT)))
def test_imports_point_one_way(path: Path) -> None:
    room = _room(path)
    if room == "__init__":
        return
    assert set(_imports(path)) - {room} <= MAY_IMPORT[room]


MOST_LINES, MOST_LINES_OF_A_FUNCTION = 300, 50


def _body_lines(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Lines from the first statement on: a signature with an option a line and a docstring do not count."""
    statements = node.body[1:] if ast.get_docstring(node) and len(node.body) > 1 else node.body
    return (node.end_lineno or 0) - statements[0].lineno + 1


@pytest.mark.parametrize("path", _sources(), ids=lambda p: str(p.relative_to(ROOT)))
def test_files_and_functions_stay_small(path: Path) -> None:
    text = path.read_text()
    assert text.count("\n") <= MOST_LINES
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            assert _body_lines(node) <= MOST_LINES_OF_A_FUNCTION, f"{node.name} is too long"
    assert path.stem not in {"utils", "common", "misc", "helpers"}


def test_rooms_hold_few_files_at_one_level() -> None:
    for folder in {path.parent for path in _sources()}:
        if folder.name not in ONE_FILE_A_VERB:
            assert len(list(folder.glob("*.py"))) <= MOST_FILES, folder


def _protocol_members() -> set[str]:
    """Names that a documented interface of the package explains."""
    found = set()
    for path in _sources():
        for node in ast.walk(ast.parse(path.read_text())):
            bases = {ast.unparse(b).partition("[")[0] for b in node.bases} if isinstance(node, ast.ClassDef) else set()
            if isinstance(node, ast.ClassDef) and bases & {"Protocol", "ABC"}:
                found |= {m.name for m in node.body if isinstance(m, ast.FunctionDef) and ast.get_docstring(m)}
    return found


def test_public_methods_have_a_docstring_here_or_in_the_interface_they_implement() -> None:
    explained = _protocol_members()
    for path in _sources():
        classes = [n for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.ClassDef)]
        for node in classes:
            for member in node.body if not node.name.startswith("_") else ():
                if isinstance(member, ast.FunctionDef) and not member.name.startswith("_"):
                    is_setter = any(ast.unparse(d).endswith(".setter") for d in member.decorator_list)
                    assert ast.get_docstring(member) or is_setter or member.name in explained, (
                        f"{path}: {node.name}.{member.name} says nowhere what it does"
                    )


def test_learning_never_asks_a_model() -> None:
    for path in (ROOT / "learning").rglob("*.py"):
        assert not {"vlm", "images", "predicates", "demos"} & set(_imports(path)), path


def test_truth_of_words_is_offered_by_domains_alone() -> None:
    for path in _sources():
        if _room(path) not in ("domains", "registry"):
            assert "domains" not in set(_imports(path)), path
    for path in (ROOT / "domains").rglob("*.py"):
        if path.name not in ("truth.py", "domain.py"):  # what a domain knows of the truth is an option of its interface
            assert "truth" not in {i.rpartition(".")[2] for i in _full_imports(path)}, path


def _full_imports(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom):
            yield str(node.module)


def test_importing_the_package_loads_nothing_heavy() -> None:
    code = "import sys, pix2pred; print(sorted({'numpy', 'PIL', 'pydantic', 'sklearn'} & set(sys.modules)))"
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert printed.strip() == "[]"


def test_docstrings_point_to_sections_that_exist() -> None:
    headings = set(
        re.findall(r"^#+ (\d+(?:\.\d+)?)\.? ", (DOCS / "method.md").read_text(encoding="utf-8"), re.MULTILINE)
    )
    for path in _sources():
        cited = re.findall(r"\bmethod (\d+(?:\.\d+)?)", path.read_text())
        assert set(cited) <= headings, path


@pytest.mark.parametrize("option", ["--help", "--version"])
def test_asking_the_command_line_for_help_imports_no_room(option: str) -> None:
    code = (
        f"import sys; from pix2pred.cli.app import run; run(['{option}']); print(*sorted(sys.modules), file=sys.stderr)"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {module.split(".")[1] for module in ran.stderr.split() if module.startswith("pix2pred.")}
    assert ran.stdout and loaded == {"cli", "system"}


def test_planning_a_pddl_problem_imports_neither_models_nor_learning_of_predicates() -> None:
    code = "import sys, pix2pred.cli.plan_pddl; print(*sorted(sys.modules))"
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    loaded = {module.split(".")[1] for module in printed.split() if module.startswith("pix2pred.")}
    assert not {"execution", "predicates", "learning", "approaches", "demos"} & loaded
