"""The corrections file: nothing confirmed is lost, and nobody's edit is overwritten unseen."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import pytest

from lamps_run import learn_lamps
from pix2pred.learning import load_traces
from pix2pred.predicates import CORRECTIONS
from pix2pred.predicates.correction_rows import parse_row
from pix2pred.review import CorrectionLog, StaleError
from pix2pred.runs.layout import AS_SAID


def label(state: int, old: str, new: str, demo: str = "d0", name: str = "l1") -> Any:
    fields = {"kind": "label", "when": "now", "demo": demo, "state": state, "atom": ["lit0", name]}
    return parse_row(json.dumps({**fields, "old": old, "new": new}))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return learn_lamps(tmp_path).path


def open_log(folder: Path) -> CorrectionLog:
    return CorrectionLog(folder, load_traces(folder / AS_SAID).table)


def test_an_edit_that_does_not_know_the_present_value_is_refused(folder: Path) -> None:
    one, other = open_log(folder), open_log(folder)
    one.append([label(0, "false", "true")])
    with pytest.raises(StaleError) as refused:
        other.append([label(0, "false", "unknown")])
    assert refused.value.present == "true"
    other.append([label(1, "true", "unknown")])
    assert len(one.rows()) == 2


def test_many_writers_lose_nothing(folder: Path) -> None:
    names = [(d, n, t) for d in ("d0", "d1") for n in ("l1", "l2") for t in range(3)]
    said = {("l1", 0): "false", ("l1", 1): "true", ("l1", 2): "true", ("l2", 0): "false", ("l2", 1): "false"}

    def work(part: list[tuple[str, str, int]]) -> None:
        log = open_log(folder)
        for demo, name, state in part:
            log.append([label(state, said.get((name, state), "true"), "unknown", demo, name)])

    threads = [threading.Thread(target=work, args=(names[i::4],)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert {(r.demo, r.atom[1], r.state) for r in open_log(folder).rows() if r.kind == "label"} == set(names)


def test_a_torn_line_is_cut_off_before_the_next(folder: Path) -> None:
    log = open_log(folder)
    log.append([label(0, "false", "true")])
    with (folder / CORRECTIONS).open("ab") as file:
        file.write(b'{"kind": "label", "dem')
    log.append([label(1, "true", "false")])
    assert [r.new for r in log.rows()] == ["true", "false"]
    assert (folder / CORRECTIONS).read_bytes().count(b"\n") == 2


PROGRAM = """
import json, sys
from pathlib import Path
from pix2pred.learning import load_traces
from pix2pred.predicates.correction_rows import parse_row
from pix2pred.review import CorrectionLog
from pix2pred.runs.layout import AS_SAID
folder = Path(sys.argv[1])
log = CorrectionLog(folder, load_traces(folder / AS_SAID).table)
words = ["false", "true"]
for i in range(100000):
    row = {"kind": "label", "when": str(i), "demo": "d0", "state": 0, "atom": ["lit0", "l1"],
           "old": words[i % 2], "new": words[(i + 1) % 2]}
    log.append([parse_row(json.dumps(row))])
    print(i, flush=True)
"""


def test_a_kill_loses_nothing_that_was_confirmed(folder: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, str(folder)], stdout=subprocess.PIPE, text=True, bufsize=1
    )
    assert process.stdout is not None
    for _ in range(5):
        process.stdout.readline()
    time.sleep(0.05)
    process.send_signal(signal.SIGKILL)
    confirmed = 5 + len([line for line in process.stdout if line.endswith("\n")])
    process.wait()
    rows = open_log(folder).rows()
    assert confirmed <= len(rows) <= confirmed + 1
    assert [r.when for r in rows] == [str(i) for i in range(len(rows))]
