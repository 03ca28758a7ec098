"""Every command that README and docs print is one that the program understands, and every setting exists."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest
from cyclopts import CycloptsError

from pix2pred.cli.app import app
from pix2pred.settings import of_file, resolve

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
_FENCE = re.compile(r"^```\w*\n(.*?)^```", re.DOTALL | re.MULTILINE)
_INLINE = re.compile(r"`((?:pix2pred [^`]*))`")


def commands(page: str) -> Iterator[str]:
    """Lines of fenced blocks and code spans that begin with the program's name, without comments."""
    blocks = "\n".join(re.sub(r" \\\n\s*", " ", block) for block in _FENCE.findall(page))
    lines = [line.strip().removeprefix("$ ") for line in blocks.splitlines()]
    for text in (*lines, *_INLINE.findall(_FENCE.sub("", page))):
        words = " ".join(text.split())
        if words.startswith("pix2pred ") and not re.search(r"\.\.\.|…|\[|\$@", words):  # a pattern, not a command
            yield re.split(r" +[#|<>&]", words)[0].replace("--seed S", "--seed 0")


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_every_printed_command_is_understood(page: Path) -> None:
    for command in commands(page.read_text(encoding="utf-8")):
        words = shlex.split(command)[1:]
        if len(words) == 1 or words[0].isupper():  # a verb spoken of, not a command
            continue
        try:
            app.parse_args(words, exit_on_error=False, print_error=False)
        except CycloptsError as error:
            if "requires an argument" in str(error) or "Missing" in type(error).__name__:
                continue  # spoken of in part, as `pix2pred learn --resume`
            pytest.fail(f"{page.name}: {command}: {error}")


def test_settings_that_the_readme_names_exist(tmp_path: Path) -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    found = re.findall(r"`(\w+: [\w-]+)`", text)
    assert found
    for setting in found:
        (tmp_path / "settings.yaml").write_text(setting + "\n")
        assert resolve(of_file(tmp_path / "settings.yaml"))
