"""Locks hold between processes, never follow a link and never touch what is in a file."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from pix2pred.review.log import CorrectionLog
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.structs import TruthTable
from pix2pred.system.files import read_regular, write_whole
from pix2pred.system.locks import LockedError, held

HOLD = "import sys; from pathlib import Path; from pix2pred.system.locks import held\n" + (
    "with held(Path(sys.argv[1]), wait=False): print('held', flush=True); sys.stdin.read()"
)
KINDS = ("link", "dangling link", "pipe", "folder")


def spoil(path: Path, kind: str, victim: Path) -> None:
    """Put something at ``path`` that is no plain file."""
    match kind:
        case "link":
            victim.write_text("precious")
            path.symlink_to(victim)
        case "dangling link":
            path.symlink_to(victim)
        case "pipe":
            os.mkfifo(path)
        case _:
            path.mkdir()


def test_a_lock_excludes_other_processes_and_ends_with_its_holder(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    with subprocess.Popen(
        [sys.executable, "-c", HOLD, str(path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        with pytest.raises(LockedError, match="another process"), held(path, wait=False):
            pass
        holder.kill()
    with held(path, wait=False), pytest.raises(LockedError), held(path, wait=False):
        pass


def test_what_is_in_a_lock_file_stays(tmp_path: Path) -> None:
    (tmp_path / "lock").write_text("precious")
    with held(tmp_path / "lock", wait=True):
        pass
    assert (tmp_path / "lock").read_text() == "precious"


@pytest.mark.parametrize("kind", KINDS)
def test_a_lock_is_a_plain_file(tmp_path: Path, kind: str) -> None:
    spoil(tmp_path / "lock", kind, tmp_path / "victim")
    with pytest.raises(OSError, match="plain file"), held(tmp_path / "lock", wait=True):
        pass
    assert not (tmp_path / "victim").exists() or (tmp_path / "victim").read_text() == "precious"


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_is_not_locked_with_anything_else(tmp_path: Path, kind: str) -> None:
    run = tmp_path / "run"
    run.mkdir()
    spoil(run / ".lock", kind, tmp_path / "victim")
    with pytest.raises(RunFolderError, match=r"\.lock: is .*; remove it"), RunFolder(run).locked():
        pass
    assert not (tmp_path / "victim").exists() or (tmp_path / "victim").read_text() == "precious"


@pytest.mark.parametrize("name", ["corrections.jsonl", ".corrections.jsonl.lock"])
@pytest.mark.parametrize("kind", KINDS)
def test_corrections_are_appended_to_plain_files_alone(tmp_path: Path, kind: str, name: str) -> None:
    run = tmp_path / "run"
    run.mkdir()
    spoil(run / name, kind, tmp_path / "victim")
    with pytest.raises(OSError, match=r"plain file|Is a directory"):
        CorrectionLog(run, TruthTable((), (), ())).append([])
    assert not (tmp_path / "victim").exists() or (tmp_path / "victim").read_text() == "precious"


@pytest.mark.parametrize("kind", ["link", "dangling link", "pipe"])
def test_a_file_that_is_written_replaces_what_was_there(tmp_path: Path, kind: str) -> None:
    spoil(tmp_path / "file", kind, tmp_path / "victim")
    write_whole(tmp_path / "file", b"new")
    assert (tmp_path / "file").read_bytes() == b"new"
    assert not (tmp_path / "file").is_symlink()
    assert not (tmp_path / "victim").exists() or (tmp_path / "victim").read_text() == "precious"


def test_reading_follows_links_but_waits_for_no_pipe(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("content")
    (tmp_path / "link").symlink_to(tmp_path / "file")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "to-pipe").symlink_to(tmp_path / "pipe")
    assert read_regular(tmp_path / "link") == b"content"
    for name in ("pipe", "to-pipe"):
        with pytest.raises(OSError, match="is a pipe"):
            read_regular(tmp_path / name)
