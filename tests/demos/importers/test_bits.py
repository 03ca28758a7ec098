"""States as bits: what becomes of them, what is wrong with them, and operators learned from them."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest

from command_line import Cli
from pix2pred.demos.files.problems import FolderError
from pix2pred.demos.importers import traces_of_bits
from pix2pred.structs.formats.traces import load_traces

WALK = "1 0 0\n0\n0 1 0\n1\n0 0 1\n"


@pytest.fixture
def cli(capfd: pytest.CaptureFixture[str]) -> Cli:
    return Cli(lambda: (read := capfd.readouterr()) and (read.out, read.err))


@pytest.mark.parametrize(
    "text",
    [
        WALK,
        WALK.replace(" ", ""),
        WALK.replace(" ", ","),
        "\ufeff\n\n" + WALK.replace("\n", "\r\n"),
        "\n".join(f"[{line.replace(' ', ', ')}]" if line else "" for line in WALK.split("\n")),
    ],
)
def test_bits_in_any_spacing_are_read(tmp_path: Path, text: str) -> None:
    (tmp_path / "b.txt").write_bytes(text.encode())
    (demo,) = traces_of_bits(tmp_path / "b.txt")["demos"]
    assert demo["states"] == [[["z0"]], [["z1"]], [["z2"]]]
    assert demo["actions"] == [["a0"], ["a1"]] and demo["goal"] == [["z2"]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "holds no trace"),
        ("1 0\n", "b.txt:1: a trace has an action between two states"),
        ("1 0\n0\n", "b.txt:2: a trace has an action between two states"),
        ("1 0\nx\n0 1\n", "b.txt:2: expected the number of an action, found 'x'"),
        ("1 2\n0\n0 1\n", "b.txt:1: expected the bits of a state"),
        ("1 0\n0\n0 1 1\n", "b.txt:3: a state of 3 bits, where the first has 2"),
        (WALK + "\n1\n0\n0\n", "b.txt:7: a state of 1 bits, where the first trace has 3"),
        ("1\n99999999999999999999\n0\n", "expected the number of an action"),
    ],
)
def test_what_is_wrong_is_named_by_line(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "b.txt").write_text(text)
    with pytest.raises(FolderError) as caught:
        traces_of_bits(tmp_path / "b.txt")
    assert message in str(caught.value)


@pytest.mark.parametrize("seed", range(3))
def test_junk_is_one_error(tmp_path: Path, seed: int) -> None:
    (tmp_path / "b.txt").write_bytes(random.Random(seed).randbytes(2000))
    with pytest.raises(FolderError):
        traces_of_bits(tmp_path / "b.txt")


def test_operators_are_learned_from_bits(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "b.txt").write_text(WALK + "\n" + WALK)
    ran = cli("import", "bits", tmp_path / "b.txt", "--out", tmp_path / "b.json", "--json")
    assert ran.code == 0 and (ran.json["traces"], ran.json["bits"], ran.json["actions"]) == (2, 3, 2)
    assert len(load_traces(tmp_path / "b.json").table.demos) == 2
    before = (tmp_path / "b.json").stat()
    assert cli("import", "bits", tmp_path / "b.txt", "--out", tmp_path / "b.json").code == 2
    assert (tmp_path / "b.json").stat() == before
    ran = cli("select", tmp_path / "b.json", "--out", tmp_path / "selection.json", "--pddl", tmp_path / "pddl")
    assert ran.code == 0, ran.err
    domain = (tmp_path / "pddl/domain.pddl").read_text()
    assert domain.count("(:action") == 2 and "(not (z0))" in domain
    assert json.loads((tmp_path / "b.json").read_text())["format"] == "pix2pred-traces"
