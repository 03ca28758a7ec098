"""Run folders and answer stores that are damaged, foreign, in the wrong place, or on a full disk."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import resource
import signal
import sys
from pathlib import Path
from typing import IO, Any

import pytest

import cli.hostile_lamps as lamps
from cli.hostile import FailsAt, Model, NothingDrawn, edit, finish, refused, said, start, tree, whole
from command_line import Cli
from pix2pred.vlm import VLMError

DAMAGED_YAML: dict[str, bytes] = {
    "open": b"vlm: {",
    "empty": b"",
    "list": b"- 1\n",
    "not UTF-8": b"vlm: \xff\xfe",
    "tag": b'vlm: !!python/object/apply:os.system ["touch pwned"]\n',
    "aliases": b"a: &a [x, x, x, x, x, x, x, x, x]\n"
    + b"".join(b"%c: &%c [%s]\n" % (c, c, b", ".join([b"*%c" % (c - 1)] * 9)) for c in range(ord("b"), ord("k"))),
    "deep": b"[" * 100_000,
    "keys missing": b"vlm: offline\n",
    "wrong values": b"{vlm: [1], model: 'fake:1', simulator: x, settings: 3, answers: 7}",
}


@pytest.mark.parametrize("content", DAMAGED_YAML.values(), ids=DAMAGED_YAML)
@pytest.mark.parametrize("verb", ["learn", "solve"])
def test_a_damaged_config_is_named_and_never_executed(
    cli: Cli, data: Path, done: Path, monkeypatch: pytest.MonkeyPatch, verb: str, content: bytes
) -> None:
    monkeypatch.chdir(done.parent)
    (done / "config.yaml").write_bytes(content)
    before = tree(done)
    if verb == "learn":
        refused(cli("learn", data, "--out", done), done)
    else:
        refused(cli("solve", done, "--tasks", data, "--plan-only"), done / "config.yaml")
    assert tree(done) == before and not (done.parent / "pwned").exists()


@pytest.mark.parametrize(
    "content", [c for n, c in DAMAGED_YAML.items() if n in ("open", "not UTF-8", "tag", "list", "aliases", "deep")]
)
def test_a_damaged_settings_file_is_named_and_never_executed(
    cli: Cli, model: Model, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, content: bytes
) -> None:
    monkeypatch.chdir(tmp_path)
    config = tmp_path / "settings.yaml"
    config.write_bytes(content)
    refused(cli("learn", data, "--out", tmp_path / "run", "--config", config), config)
    assert not (tmp_path / "pwned").exists() and not (tmp_path / "run").exists()


@pytest.mark.parametrize("where", ["config.yaml", "model/world_model.json", "answers", "evidence/index.json"])
def test_a_pipe_in_place_of_a_file_is_not_waited_for(cli: Cli, data: Path, done: Path, where: str) -> None:
    victims = [done / where] if "." in where else [min((done / where).rglob("*.json"))]
    if not victims[0].exists():
        victims = [min((done / "labels").glob("*.json"))]
    victims[0].unlink()
    os.mkfifo(victims[0])
    for told in (("learn", data, "--out", done), ("answers", "list", done), ("answers", "verify", done)):
        ran = cli(*told)
        assert ran.code in (0, 2) and "Traceback" not in ran.err


MODELS: dict[str, bytes | None] = {
    "missing": None,
    "empty": b"",
    "list": b"[]",
    "binary": b"\xff\x00",
    "pickle": b"\x80\x04cos\nsystem\n(S'touch pwned'\ntR.",
    "version 2": b'{"format": "pix2pred-world-model", "version": 2}',
}


@pytest.mark.parametrize("content", MODELS.values(), ids=MODELS)
def test_a_damaged_world_model_is_named(cli: Cli, data: Path, done: Path, content: bytes | None) -> None:
    path = done / "model" / "world_model.json"
    if content is None:
        path.unlink()
    else:
        path.write_bytes(content)
    refused(cli("solve", done, "--tasks", data, "--plan-only"), path)


def test_solving_before_learning_has_finished_says_so(cli: Cli, model: Model, data: Path, tmp_path: Path) -> None:
    fails = FailsAt(7, VLMError("quota"))
    model(propose=fails, label=fails)
    cli("learn", data, "--out", tmp_path / "run")
    refused(cli("solve", tmp_path / "run", "--tasks", data, "--plan-only"), "pix2pred learn")


@pytest.mark.parametrize(
    "content", [b"", b"{}", b"[1]", b'{"version": 9, "answer": "x"}', b'{"version": 1, "answer": 3}']
)
def test_damaged_stored_answers_are_named(cli: Cli, data: Path, done: Path, content: bytes) -> None:
    victim = sorted(done.glob("answers/*/*.json"))[0]
    victim.write_bytes(content)
    refused(cli("learn", data, "--out", done), victim)


def test_damaged_metrics_are_written_again(cli: Cli, data: Path, done: Path) -> None:
    before = tree(done)
    (done / "metrics.json").write_text("{")
    assert cli("learn", data, "--out", done).code == 0 and tree(done) == before


def test_a_run_of_another_reader_is_not_continued(cli: Cli, model: Model, data: Path, done: Path) -> None:
    model(name="fake:2")
    before = tree(done)
    refused(cli("learn", data, "--out", done), done, "model")
    refused(cli("solve", done, "--tasks", data, "--plan-only"), "fake:1", "fake:2")
    assert tree(done) == before


def test_a_run_of_other_data_is_not_overwritten(cli: Cli, data: Path, done: Path, tmp_path: Path) -> None:
    other = lamps.write_lamps(tmp_path / "other", 1)
    edit(other / "domain.yaml", "name: lamps", "name: others")
    before = tree(done)
    refused(cli("learn", other, "--out", done), done)
    assert tree(done) == before


def test_the_run_folder_cannot_be_the_data(cli: Cli, model: Model, data: Path) -> None:
    before = sorted(str(p) for p in data.rglob("*"))
    refused(cli("learn", data, "--out", data), data, "not a run folder")
    assert [p for p in sorted(str(p) for p in data.rglob("*")) if not p.endswith(".lock")] == before


def test_a_refused_run_folder_is_left_without_a_trace(cli: Cli, model: Model, data: Path) -> None:
    before = sorted(data.rglob("*"))
    refused(cli("learn", data, "--out", data))
    assert sorted(data.rglob("*")) == before


def test_a_run_folder_among_the_demonstrations_is_refused(cli: Cli, model: Model, data: Path) -> None:
    cli("learn", data, "--out", data / "demos" / "run")
    assert cli("check", data).code == 0


def test_a_run_folder_beside_the_demonstrations(cli: Cli, model: Model, data: Path) -> None:
    assert cli("learn", data, "--out", data / "runs" / "1").code == 0
    assert cli("check", data).code == 0


def test_a_misspelt_run_is_not_created(cli: Cli, tmp_path: Path) -> None:
    refused(cli("solve", tmp_path / "runs" / "typo"), "typo", "holds no run")
    assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize("verb", ["learn", "solve", "generate", "demo"])
@pytest.mark.parametrize("where", ["file", "file/below"])
def test_a_file_in_place_of_a_folder(cli: Cli, model: Model, data: Path, tmp_path: Path, verb: str, where: str) -> None:
    precious = tmp_path / "file"
    precious.write_text("precious")
    target = tmp_path / where
    args = {
        "learn": ("learn", data, "--out", target),
        "solve": ("solve", target),
        "generate": ("generate", "burger", "--tasks", 0, "--out", target),
        "demo": ("demo", "--out", target),
    }[verb]
    if verb in ("generate", "demo"):
        cli.registry = NothingDrawn()
    refused(cli(*args), tmp_path / "file")
    assert precious.read_text() == "precious"


@pytest.mark.parametrize("name", ["a b", "a\nb", "ü ☃ 漢", "-x", "[bold]x", "q[/y]", "a" * 200])
def test_odd_folder_names(
    cli: Cli, model: Model, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    out = tmp_path / name
    ran = cli("learn", data, f"--out={out}")
    assert ran.code == 0, ran.err
    assert (out / "metrics.json").exists()
    assert "".join(name.split()) in "".join(ran.err.split())
    assert cli("solve", out, "--tasks", data, "--plan-only").code == 0


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="names of files are text there")
@pytest.mark.parametrize("name", [b"caf\xe9", b"\xff\xfe", b"run\\1\\g<0>\xe9"])
def test_folder_names_that_are_no_text(cli: Cli, model: Model, data: Path, tmp_path: Path, name: bytes) -> None:
    out = tmp_path / os.fsdecode(name)
    ran = cli("learn", data, f"--out={out}")
    assert ran.code == 0, ran.err
    assert (out / "report.html").read_text(encoding="utf-8")
    assert cli("solve", out, "--tasks", data, "--plan-only").code == 0
    assert cli("learn", "--resume", out).code == 0
    assert cli("runs", "list", tmp_path).code == 0


def test_relative_paths_may_be_used_from_elsewhere(
    cli: Cli, model: Model, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli("learn", "data", "--out", "runs/a", "--answers", "store").code == 0
    assert not (tmp_path / "runs/a/answers").exists()
    monkeypatch.chdir("/")
    assert cli("learn", data, "--out", tmp_path / "runs/a", "--answers", tmp_path / "store").code == 0
    assert cli("solve", tmp_path / "runs/a", "--tasks", data, "--plan-only").code == 0


def test_two_runs_share_a_store(cli: Cli, model: Model, data: Path, tmp_path: Path) -> None:
    store = tmp_path / "store"
    fake = model()
    assert cli("learn", data, "--out", tmp_path / "a", "--answers", store).code == 0
    asked = len(fake.asked)
    assert cli("learn", data, "--out", tmp_path / "b", "--answers", store, "--mode", "replay").code == 0
    assert len(fake.asked) == asked == 12
    config = f"answers: {store}"
    assert config in (tmp_path / "a/config.yaml").read_text() and tree(tmp_path / "a") == tree(tmp_path / "b")


def test_replaying_an_empty_store_names_the_option_that_helps(
    cli: Cli, model: Model, data: Path, tmp_path: Path
) -> None:
    fake = model()
    ran = cli("learn", data, "--out", tmp_path / "run", "--mode", "replay")
    refused(ran, "has no answer", tmp_path / "run")
    assert not fake.asked
    assert "--mode resume" in said(ran)


def test_live_asks_every_time(cli: Cli, data: Path, done: Path, model: Model) -> None:
    fake = model()
    before = tree(done)
    assert cli("learn", data, "--out", done, "--mode", "live").code == 0
    assert len(fake.asked) == 12 and tree(done) == before


def test_a_wrong_answers_folder_does_not_spoil_the_run_folder(
    cli: Cli, model: Model, data: Path, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("precious")
    refused(cli("learn", data, "--out", tmp_path / "run", "--answers", tmp_path / "file"), tmp_path / "file")
    assert (tmp_path / "file").read_text() == "precious"
    assert cli("learn", data, "--out", tmp_path / "run").code == 0


class _FullDisk(contextlib.AbstractContextManager["_FullDisk"]):
    """A file of which half is written before the disk is full; a failing write carries no file name."""

    def __init__(self, file: IO[Any]) -> None:
        self._file = file

    def write(self, content: bytes) -> int:
        self._file.write(content[: len(content) // 2])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def __exit__(self, *_: object) -> None:
        self._file.close()


@pytest.mark.parametrize("victim", ["config.yaml", "answers", "blobs", "world_model.json", "metrics.json"])
def test_a_full_disk_is_named_and_learning_resumes(
    cli: Cli, model: Model, data: Path, done: Path, tmp_path: Path, victim: str
) -> None:
    run = tmp_path / "run"
    full = pytest.MonkeyPatch()
    real = Path.open

    def fill(path: Path, mode: str = "r", *rest: Any, **options: Any) -> Any:
        file = real(path, mode, *rest, **options)
        return _FullDisk(file) if "r" not in mode and victim in str(path) else file

    full.setattr(Path, "open", fill)
    ran = cli("learn", data, "--out", run)
    full.undo()
    refused(ran, "No space left on device")
    assert re.search(r"make room|name another folder", " ".join(ran.err.lower().split())), "says what to do"
    whole(run)
    assert cli("learn", data, "--out", run).code == 0
    assert tree(run) == tree(done)


def test_the_message_of_a_full_disk_says_where(data: Path, tmp_path: Path) -> None:
    def limit() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))

    ran = finish(start(0, "learn", data, "--out", tmp_path / "run", preexec_fn=limit))
    refused(ran, "File too large")
    whole(tmp_path / "run")
    assert finish(start(0, "learn", data, "--out", tmp_path / "run")).code == 0
    assert str(tmp_path / "run") in said(ran)
