"""What a killed process had begun to write goes; what others are writing stays."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from pix2pred.runs.folder import RunFolder
from pix2pred.system.files import check_writable, remove_abandoned, write_whole
from pix2pred.vlm.answers.store import AnswerStore


@pytest.fixture(scope="module")
def ended() -> int:
    """The number of a process that has ended."""
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


def _begun(folder: Path, process: int) -> Path:
    path = folder / f".answer.json.{process}.1.part"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"{")
    return path


def test_a_run_folder_is_rid_of_half_written_files_whatever_works_in_it(tmp_path: Path, ended: int) -> None:
    left = [_begun(tmp_path / place, ended) for place in (".", "answers/ab", "blobs", "solve/x")]
    with RunFolder(tmp_path).locked():
        assert not any(path.exists() for path in left)


def test_a_store_elsewhere_is_rid_of_them_before_it_is_written_to(tmp_path: Path, ended: int) -> None:
    left = _begun(tmp_path / "answers/ab", ended)
    AnswerStore(tmp_path).check_writable()
    assert not left.exists() and not list((tmp_path / "answers").glob("*.*"))


def test_what_a_running_process_writes_stays(tmp_path: Path) -> None:
    kept = [_begun(tmp_path, os.getppid()), _begun(tmp_path, os.getpid())]
    remove_abandoned(tmp_path)
    assert all(path.exists() for path in kept)


def test_what_an_earlier_process_of_the_same_number_left_goes(tmp_path: Path) -> None:
    left = _begun(tmp_path, os.getpid())
    os.utime(left, (0, 0))
    remove_abandoned(tmp_path)
    assert not left.exists()


def test_files_that_come_and_go_meanwhile_are_no_error(tmp_path: Path) -> None:
    ended_too = threading.Event()

    def write() -> None:
        while not ended_too.is_set():
            write_whole(tmp_path / "file", b"x")

    writer = threading.Thread(target=write)
    writer.start()
    try:
        for _ in range(300):
            remove_abandoned(tmp_path)
    finally:
        ended_too.set()
        writer.join()
    assert (tmp_path / "file").read_bytes() == b"x"


def test_other_files_are_nobodys_business(tmp_path: Path, ended: int) -> None:
    names = (".part", f".a.{ended}.part", f"a.{ended}.1.part", f".a.{ended}.1.parts", ".a.x.1.part")
    for name in names:
        (tmp_path / name).write_bytes(b"")
    remove_abandoned(tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(names)


def test_asking_whether_a_folder_can_be_written_leaves_nothing(tmp_path: Path) -> None:
    check_writable(tmp_path / "new")
    assert list((tmp_path / "new").iterdir()) == []
    write_whole(tmp_path / "file", b"")
    with pytest.raises(OSError, match="file"):
        check_writable(tmp_path / "file")
