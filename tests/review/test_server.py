"""The review server: whom it answers, what it takes, and that corrections reach learning."""

from __future__ import annotations

import http.client
import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from lamps_run import learn_lamps
from pix2pred.predicates import CORRECTIONS
from pix2pred.review import ReviewServer
from pix2pred.review.loopback import LoopbackServer
from pix2pred.review.session import ReviewSession
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.learn import LearnedRun


@contextmanager
def serving(made: ReviewServer) -> Iterator[ReviewServer]:
    with made:
        thread = threading.Thread(target=made.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
        thread.start()
        yield made
        made.shutdown()


@pytest.fixture
def server(tmp_path: Path) -> Iterator[ReviewServer]:
    with serving(ReviewServer(learn_lamps(tmp_path))) as made:
        yield made


def ask(
    server: LoopbackServer, path: str, body: Any = None, method: str | None = None, **headers: str
) -> tuple[int, Any]:
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=60)
    sent = {k.replace("_", "-"): v for k, v in headers.items()}
    data = None
    if body is not None:
        data = body if isinstance(body, bytes) else json.dumps(body).encode()
        sent.setdefault("Content-Type", "application/json")
    connection.request(method or ("POST" if data is not None else "GET"), path, data, sent)
    answer = connection.getresponse()
    text = answer.read().decode()
    connection.close()
    return answer.status, json.loads(text) if answer.headers["Content-Type"] == "application/json" else text


def flip(state: int, old: str, new: str) -> dict[str, Any]:
    return {"kind": "label", "demo": "d0", "state": state, "atom": ["lit0", "l1"], "old": old, "new": new}


def test_it_listens_on_the_loopback_alone_and_its_address_holds_a_token(server: ReviewServer) -> None:
    assert server.server_address[0] == "127.0.0.1"
    assert len(server.token) >= 32
    status, text = ask(server, f"/{server.token}/")
    assert status == 200 and "Learn again" in text and server.token not in text


@pytest.mark.parametrize("path", ["/", "/state", "/wrong/", "/wrong/corrections", "//", "/%00/"])
def test_without_the_token_there_is_nothing(server: ReviewServer, path: str) -> None:
    assert ask(server, path)[0] == 403
    assert ask(server, path, [flip(0, "false", "true")])[0] == 403
    assert not (server.session.run.path / CORRECTIONS).exists()


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "evil.example:{port}"},
        {"Host": "127.0.0.1.evil.example:{port}"},
        {"Host": "127.0.0.1"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:1"},
        {"Origin": "http://localhost:{port}"},
        {"Sec_Fetch_Site": "cross-site"},
        {"Sec_Fetch_Site": "same-site"},
    ],
)
def test_other_sites_and_rebound_names_are_refused(server: ReviewServer, headers: dict[str, str]) -> None:
    sent = {k: v.format(port=server.server_port) for k, v in headers.items()}
    assert ask(server, f"/{server.token}/", **sent)[0] == 403
    assert ask(server, f"/{server.token}/corrections", [flip(0, "false", "true")], **sent)[0] == 403
    assert not (server.session.run.path / CORRECTIONS).exists()


def test_forms_of_other_sites_cannot_post(server: ReviewServer) -> None:
    body = json.dumps([flip(0, "false", "true")]).encode()
    assert ask(server, f"/{server.token}/corrections", body, Content_Type="text/plain")[0] == 415
    assert ask(server, f"/{server.token}/corrections", b"", method="OPTIONS")[0] == 501
    assert not (server.session.run.path / CORRECTIONS).exists()


@pytest.mark.parametrize(
    ("body", "status"),
    [
        (b"{", 400),
        (b"[" * 100_000, 400),
        (b'{"a": 1}', 400),
        (b"[1]", 400),
        (b"x" * (1 << 20) + b"y", 413),
        ([{"kind": "label"}], 400),
        ([{"kind": "shell", "new": "rm"}], 400),
        ([flip(9, "false", "true")], 400),
        ([flip(0, "true", "false")], 409),
        ([{"kind": "rename", "predicate": "lit0", "old": "lit0", "new": "two words"}], 400),
        ([{"kind": "rename", "predicate": "../lit0", "old": "../lit0", "new": "x"}], 400),
        (b'[{"kind": "label", "demo": ' + b"[" * 900 + b"]" * 900 + b"}]", 400),
        (b'[{"kind": "rename", "predicate": "lit0", "old": "lit0", "new": "\\ud800"}]', 400),
    ],
    ids=range(13),
)
def test_nonsense_is_refused_and_not_saved(server: ReviewServer, body: Any, status: int) -> None:
    got, _ = ask(server, f"/{server.token}/corrections", body)
    assert got == status
    path = server.session.run.path / CORRECTIONS
    assert not path.exists() or path.read_bytes() == b""


def test_two_pages_do_not_lose_each_others_edits(server: ReviewServer) -> None:
    at = f"/{server.token}/corrections"
    assert ask(server, at, [flip(0, "false", "true")])[0] == 200
    status, answer = ask(server, at, [flip(0, "false", "unknown")])
    assert status == 409
    assert ["d0", 0, ["lit0", "l1"], "true"] in answer["corrections"]["labels"]
    status, answer = ask(server, at, [flip(1, "true", "false")])
    assert status == 200 and len(answer["corrections"]["labels"]) == 2
    rows = [json.loads(line) for line in (server.session.run.path / CORRECTIONS).read_text().splitlines()]
    assert [(r["old"], r["new"]) for r in rows] == [("false", "true"), ("true", "false")]
    assert all(r["when"].endswith("Z") for r in rows)


def wait(server: ReviewServer) -> dict[str, Any]:
    for _ in range(600):
        learning: dict[str, Any] = ask(server, f"/{server.token}/state")[1]["learning"]
        if not learning["running"]:
            return learning
        time.sleep(0.1)
    raise AssertionError("learning did not end")


def test_learning_again_uses_the_corrections(server: ReviewServer) -> None:
    ban = {"kind": "standing", "predicate": "lit0", "old": "free", "new": "banned"}
    assert ask(server, f"/{server.token}/corrections", [ban])[0] == 200
    assert ask(server, f"/{server.token}/learn", {})[0] == 202
    assert wait(server) == {"running": "", "error": "", "version": 1}
    path = server.session.run.path
    assert json.loads((path / "metrics.json").read_text())["corrections"] == 1
    assert "Before and after" in (path / "report.html").read_text()


def test_damaged_files_are_said(server: ReviewServer) -> None:
    (server.session.run.path / CORRECTIONS).write_text("{nonsense}\n")
    for path in ("", "state"):
        status, text = ask(server, f"/{server.token}/{path}")
        assert status == 500 and CORRECTIONS in text
    assert ask(server, f"/{server.token}/corrections", b"[]", Content_Length="\u00b2")[0] == 415


@pytest.mark.parametrize(("length", "status"), [("9" * 5000, 400), ("9" * 19, 400), ("9" * 12, 413), ("-1", 415)])
def test_absurd_lengths_are_refused(server: ReviewServer, length: str, status: int) -> None:
    assert ask(server, f"/{server.token}/corrections", b"[]", Content_Length=length)[0] == status


def test_learning_that_fails_in_any_way_says_so(tmp_path: Path) -> None:
    def broken(*_: Any) -> LearnedRun:
        raise KeyError("lost")

    run = learn_lamps(tmp_path)
    with serving(ReviewServer(run, session=ReviewSession(run, broken))) as server:
        ask(server, f"/{server.token}/learn", {})
        assert wait(server) == {"running": "", "error": "'lost'", "version": 0}


def test_a_busy_run_folder_is_said(server: ReviewServer) -> None:
    with RunFolder(server.session.run.path).locked():
        ask(server, f"/{server.token}/learn", {})
        assert "another process" in wait(server)["error"]
