"""What a user of the installed wheel gets: types that a checker sees."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest

from extras import need

pytestmark = need("hatchling", "mypy", extra="dev")

ROOT = Path(__file__).parents[1]
PROGRAM = """
import pix2pred
from pix2pred.structs import Demo

project: pix2pred.Project = pix2pred.read_data("tea")
demo: Demo = project.demos[0]
learned: pix2pred.Model = pix2pred.learn(project, vlm="offline")
reveal_type(demo.actions[0].objects)
print(len(demo.states), learned)
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site-packages of an environment that has the wheel, and what it depends on from this environment."""
    place = tmp_path_factory.mktemp("installed")
    build = "import sys; from hatchling.build import build_wheel; print(build_wheel(sys.argv[1]))"
    done = subprocess.run(
        [sys.executable, "-c", build, str(place)], cwd=ROOT, capture_output=True, text=True, check=True
    )
    where = place / "venv"
    venv.create(where, symlinks=True)
    packages = Path(sysconfig.get_path("purelib", vars={"base": str(where), "platbase": str(where)}))
    with zipfile.ZipFile(place / done.stdout.split()[-1]) as wheel:
        wheel.extractall(packages)
    (packages / "dependencies.pth").write_text("\n".join(p for p in sys.path if p.endswith("site-packages")) + "\n")
    return packages


def python_of(site: Path) -> Path:
    where = site.parents[2] if sys.platform != "win32" else site.parents[1]
    return where / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")


def check(site: Path, place: Path, program: str) -> str:
    (place / "program.py").write_text(program)
    options = ["--strict", "--config-file=", f"--python-executable={python_of(site)}", f"--cache-dir={site / 'cache'}"]
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "MYPYPATH")}
    command = [sys.executable, "-m", "mypy", *options, "program.py"]
    done = subprocess.run(command, cwd=place, env=environment, capture_output=True, text=True, check=False)
    return done.stdout + done.stderr


def test_a_program_is_checked_against_the_types_of_the_installed_package(site: Path, tmp_path: Path) -> None:
    right = check(site, tmp_path, PROGRAM)
    assert "Success" in right, right
    assert "tuple[pix2pred.structs.objects.Object, ...]" in right
    wrong = check(site, tmp_path, PROGRAM.replace("project.demos[0]", "project.vocabulary"))
    assert 'has type "Vocabulary", variable has type "Demo"' in wrong


def test_the_wheel_says_that_it_is_typed(site: Path) -> None:
    assert (site / "pix2pred" / "py.typed").is_file()


def test_what_an_index_shows_links_to_no_file_beside_it(site: Path) -> None:
    text = next(site.glob("pix2pred-*.dist-info/METADATA")).read_text(encoding="utf-8")
    assert "*Picture: A learned operator" in text and "pix2pred demo --recorded" in text
    targets = re.findall(r"\]\(([^)]*)\)", text)
    assert targets and all(t.startswith("https:") for t in targets), targets
    assert "Project-URL: Paper, https://arxiv.org/abs/2501.00296" in text
