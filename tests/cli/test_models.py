"""The command line with a model over HTTP: killed, out of budget, refused, watched for its key."""

from __future__ import annotations

import base64
import json
import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from cli.hostile_lamps import write_lamps
from command_line import Cli
from lamps_run import learn_lamps
from pix2pred.structs import Image
from pix2pred.structs.formats.traces import load_traces
from pix2pred.structs.views import HEADING_HEIGHT
from pix2pred.vlm import Answer, AnswerStore, Purpose, Request
from vlm.fault_server import FaultServer, pictures

KILLS = int(os.environ.get("PIX2PRED_KILLS", "2"))
KEY = "sk-planted-0123456789abcdefghij"


@pytest.fixture(scope="module")
def lamps(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_lamps(tmp_path_factory.mktemp("lamps") / "project", demos=4)


@pytest.fixture
def server() -> Iterator[FaultServer]:
    with FaultServer().running() as running:
        yield running


@pytest.fixture
def quick(tmp_path: Path) -> Path:
    """A configuration whose pauses are short."""
    path = tmp_path / "quick.yaml"
    path.write_text("flow: {first_pause: 0.01, longest_pause: 0.02, timeout: 60, tries: 3}\nproposal: {attempts: 6}\n")
    return path


def model(server: FaultServer) -> str:
    return f"openai-compatible:tiny@{server.url}"


def test_learning_replaying_and_looking_at_answers(
    cli: Cli, lamps: Path, server: FaultServer, quick: Path, tmp_path: Path
) -> None:
    run = tmp_path / "run"
    ran = cli("learn", lamps, "--vlm", model(server), "--config", quick, "--out", run, "--json")
    assert ran.code == 0, ran.err
    asked = len(server.bodies)
    assert asked == 4 + 4 * 5 and not server.again
    timings = json.loads((run / "timings.json").read_text())
    assert timings["queries"]["label"]["input_tokens"] == 12 * 100
    assert set(timings["demonstrations"]) == {"d0", "d1", "d2", "d3"}
    assert cli("answers", "verify", run).code == 0
    listed = cli("answers", "list", run, "--purpose", "double-check", "--json").json["answers"]
    assert len(listed) == 8
    shown = cli("answers", "show", run, listed[0]["key"][:10]).out
    assert "Check your answer" in shown and "[before: state" in shown
    assert cli("answers", "export", run, "--out", tmp_path / "a.zip").code == 0
    subprocess.run([sys.executable, "-m", "zipfile", "-e", tmp_path / "a.zip", tmp_path / "copy"], check=True)
    again = cli("learn", lamps, "--vlm", f"replay:{tmp_path / 'copy'}", "--config", quick, "--out", tmp_path / "again")
    assert again.code == 0, again.err
    assert len(server.bodies) == asked
    assert (tmp_path / "again/labels/traces.json").read_bytes() == (run / "labels/traces.json").read_bytes()


def test_a_changed_answer_is_found(cli: Cli, lamps: Path, server: FaultServer, quick: Path, tmp_path: Path) -> None:
    run = tmp_path / "run"
    assert cli("learn", lamps, "--vlm", model(server), "--config", quick, "--out", run).code == 0
    path = min((run / "answers").rglob("*.json"))
    path.write_text(path.read_text().replace('"attempt": 0', '"attempt": 7'))
    blob = min((run / "blobs").iterdir())
    blob.unlink()
    found = cli("answers", "verify", run)
    assert found.code == 2
    assert path.name in found.out.replace("\n", "") and blob.name in found.out.replace("\n", "")
    assert "2 problems" in found.out


def start(*args: object) -> subprocess.Popen[bytes]:
    code = "from pix2pred.cli import main; main()"
    environment = os.environ | {"PIX2PRED_API_KEY": KEY}
    return subprocess.Popen(
        [sys.executable, "-c", code, *map(str, args)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=environment,
    )


def test_killed_labelling_asks_little_twice_and_ends_with_the_same_labels(
    cli: Cli, lamps: Path, quick: Path, tmp_path: Path
) -> None:
    """PIX2PRED_KILLS sets how often it is killed. The moments are counted in requests, and random within them."""
    concurrent, rng = 3, random.Random(0)
    with FaultServer().running() as server:
        assert cli("learn", lamps, "--vlm", model(server), "--config", quick, "--out", tmp_path / "whole").code == 0
        needed = len(server.bodies)
    with FaultServer(seconds=0.05).running() as server:
        run = tmp_path / "run"
        options = ("--config", quick, "--concurrent", concurrent, "--out", run)
        kills = 0
        while kills < KILLS:
            process = start("learn", lamps, "--vlm", model(server), *options)
            before = len(server.bodies)
            aim = before + rng.randint(1, max(1, needed // (KILLS + 1)))
            while process.poll() is None and len(server.bodies) < aim:
                time.sleep(0.005)
            if process.poll() is not None:
                break
            time.sleep(rng.uniform(0, 0.08))
            process.send_signal(signal.SIGKILL)
            process.wait()
            kills += 1
            verified = cli("answers", "verify", run) if (run / "answers").exists() else None
            assert verified is None or verified.code == 0, verified.out
        assert start("learn", lamps, "--vlm", model(server), *options).wait() == 0
        assert cli("answers", "verify", run).code == 0
        extra = len(server.bodies) - needed
        assert 0 <= extra <= kills * concurrent
        assert kills == KILLS or KILLS > 2
        print(f"{kills} kills, {needed} requests needed, {extra} more than needed")
    assert (run / "labels/traces.json").read_bytes() == (tmp_path / "whole/labels/traces.json").read_bytes()


def test_a_budget_of_requests_stops_cleanly_and_a_larger_one_goes_on(
    cli: Cli, lamps: Path, server: FaultServer, quick: Path, tmp_path: Path
) -> None:
    options = ("learn", lamps, "--vlm", model(server), "--config", quick, "--out", tmp_path / "run")
    ran = cli(*options, "--max-requests", 9)
    sent = len(server.bodies)
    assert ran.code == 1 and "--max-requests" in ran.err and 4 < sent <= 9
    assert len(list((tmp_path / "run/answers").rglob("*.json"))) == sent, "all that was asked is stored"
    assert cli(*options, "--max-requests", 24 - sent).code == 0
    assert len(server.bodies) == 24 and not server.again


def test_a_budget_in_dollars_needs_a_price(
    cli: Cli, lamps: Path, server: FaultServer, quick: Path, tmp_path: Path
) -> None:
    ran = cli("learn", lamps, "--vlm", model(server), "--config", quick, "--out", tmp_path / "run", "--max-cost", 1)
    assert ran.code == 1 and "price of this model is not known" in ran.err


def test_a_dry_run_asks_nothing_and_counts_what_is_asked_later(
    cli: Cli, lamps: Path, server: FaultServer, quick: Path, tmp_path: Path
) -> None:
    options = ("learn", lamps, "--vlm", model(server), "--config", quick, "--out", tmp_path / "run")
    dry = cli(*options, "--dry-run", "--json").json
    assert dry["queries"] == 24 and dry["assumed_predicates"] and not server.bodies
    assert not (tmp_path / "run").exists()
    assert cli(*options, "--max-requests", 4).code == 1
    dry = cli(*options, "--dry-run", "--json").json
    assert not dry["assumed_predicates"], "the proposals are known now"
    assert dry["stages"]["propose"]["from_store"] == 4
    assert cli(*options).code == 0
    labels = load_traces(tmp_path / "run/labels/traces.json").table.demos
    asked = sum(2 * d.values.shape[0] - 1 for d in labels)
    assert dry["atoms"] == asked * len({a for d in labels for a in d.atoms if a.predicate.name != "Done"})
    assert cli(*options, "--dry-run", "--json").json["input_tokens"] == 0


def test_the_size_of_pictures_is_chosen_counted_sent_and_part_of_the_question(
    cli: Cli, lamps: Path, server: FaultServer, quick: Path, tmp_path: Path
) -> None:
    options = ("learn", lamps, "--vlm", model(server), "--config", quick, "--answers", tmp_path / "answers")
    small, large = (
        cli(*options, "--out", tmp_path / "r", "--dry-run", "--longest-side", side, "--json").json
        for side in (128, 1024)
    )
    assert small["pictures"] == large["pictures"] and small["input_tokens"] < large["input_tokens"]
    for side in (128, 200):
        assert cli(*options, "--out", tmp_path / f"run{side}", "--longest-side", side).code == 0
        sizes = {shown_size(url) for body in server.bodies[-24:] for url in pictures(json.loads(body))}
        assert {max(width, height - HEADING_HEIGHT) for width, height in sizes} == {side}
    assert len(server.bodies) == 48, "another size is another question"
    assert cli(*options, "--out", tmp_path / "again", "--longest-side", 200).code == 0
    assert len(server.bodies) == 48
    assert cli(*options, "--out", tmp_path / "tiny", "--longest-side", 3).code == 2


def shown_size(url: str) -> tuple[int, int]:
    return Image(base64.b64decode(url.partition(",")[2])).size


def test_votes_are_stored_as_confidence(
    cli: Cli, lamps: Path, server: FaultServer, quick: Path, tmp_path: Path
) -> None:
    ran = cli("learn", lamps, "--vlm", model(server), "--config", quick, "--out", tmp_path / "run", "--votes", 3)
    assert ran.code == 0, ran.err
    assert len(server.bodies) == 4 + 3 * 20
    seeds = {json.loads(body)["seed"] for body in server.bodies}
    assert seeds == {0, 1000, 2000}
    (first, *_) = load_traces(tmp_path / "run/labels/traces.json").table.demos
    assert first.confidence is not None
    asked = [i for i, atom in enumerate(first.atoms) if atom.predicate.name != "Done"]
    assert np.all(first.confidence[:, asked] == 1.0)


@pytest.mark.parametrize(
    ("rates", "said"),
    [({"refused": 1.0}, "refused"), ({"empty": 1.0}, "an empty answer"), ({"another language": 1.0}, "no value")],
)
def test_a_useless_model_is_stopped_with_the_count_and_two_examples(
    cli: Cli, lamps: Path, quick: Path, tmp_path: Path, rates: dict[str, float], said: str
) -> None:
    with FaultServer(rates).running() as server:
        ran = cli("learn", lamps, "--vlm", model(server), "--config", quick, "--out", tmp_path / "run")
        assert ran.code == 1, ran.err
        assert "10 answers in a row were of no use" in ran.err and "(2)" in ran.err and said in ran.err.lower()
        assert len(server.bodies) <= 10 + 8 + 4


HOPELESS = {
    "nothing listens": ("openai-compatible:tiny@http://127.0.0.1:9/v1", "is the address right"),
    "a key in the address": ("openai-compatible:tiny@http://me:secret@localhost/v1", "put the key into"),
    "no address": ("openai-compatible:tiny", "is not openai-compatible:MODEL@URL"),
    "no provider": ("gpt-4o", "is not one of openai:MODEL"),
    "no key": ("openai:gpt-4o", "set the environment variable OPENAI_API_KEY"),
    "no store": ("replay:nowhere", "holds no answers to replay"),
}


@pytest.mark.parametrize("case", HOPELESS)
def test_what_cannot_work_says_so_at_once(
    cli: Cli, lamps: Path, quick: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, case: str
) -> None:
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    monkeypatch.chdir(tmp_path)
    spec, said = HOPELESS[case]
    ran = cli("learn", lamps, "--vlm", spec, "--config", quick, "--out", tmp_path / "run")
    assert ran.code == 2 and said in ran.err and "secret" not in ran.err and "Traceback" not in ran.err


@pytest.mark.parametrize("fault", ["none", "500", "401", "echo", "filtered"])
def test_a_key_appears_nowhere(
    cli: Cli, lamps: Path, quick: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: str
) -> None:
    """Neither in files nor in what is printed, with a server that repeats the key in its errors."""
    monkeypatch.setenv("PIX2PRED_API_KEY", KEY)

    class Echo(FaultServer):
        def serve(self, handler: object) -> None:
            sent = handler.headers["authorization"]  # type: ignore[attr-defined]
            status = {"500": 500, "401": 401, "echo": 400}.get(fault)
            if status is None:
                super().serve(handler)  # type: ignore[arg-type]
                return
            from vlm.fault_server import _send

            self.bodies.append("")
            message = f"Incorrect API key provided: {sent}, {KEY[:9]}...{KEY[-4:]}"
            _send(handler, status, json.dumps({"error": {"message": message}}).encode())  # type: ignore[arg-type]

    with Echo({"filtered": 0.3} if fault == "filtered" else {}).running() as server:
        run = tmp_path / "run"
        ran = cli("learn", lamps, "--vlm", model(server), "--config", quick, "--out", run)
        said = ran.out + ran.err
        for options in ((), ("--json",)):
            looked = cli("doctor", "--vlm", model(server), *options)
            said += looked.out + looked.err
        if fault == "none":
            assert ran.code == 0 and any(
                KEY in h.get("authorization", h.get("Authorization", "")) for h in server.headers
            )
            assert (run / "report.html").stat().st_size > 10_000, "searched below, like every file"
            said += cli("answers", "list", run).out
            key = cli("answers", "list", run, "--json").json["answers"][0]["key"]
            said += cli("answers", "show", run, key).out
            assert cli("answers", "export", run, "--out", tmp_path / "shared.zip").code == 0
            subprocess.run([sys.executable, "-m", "zipfile", "-e", tmp_path / "shared.zip", tmp_path / "s"], check=True)
            assert "key for openai-compatible" in said and "is set" in said
    for part in (KEY, KEY[:12], KEY[-8:]):
        assert part not in said
        for path in tmp_path.rglob("*"):
            if path.is_file():
                assert part.encode() not in path.read_bytes(), path
    port = server.url.rpartition(":")[2]
    for path in (run / "answers").rglob("*.json") if (run / "answers").exists() else ():
        content = path.read_text()
        assert str(tmp_path) not in content and port not in content and "authorization" not in content.lower()


@pytest.mark.parametrize("rates", [{}, {"500": 1.0}, {"half json": 1.0}, {"cut before": 1.0}, {"late": 1.0}], ids=str)
def test_tracebacks_and_logs_of_a_request_do_not_hold_the_key(
    rates: dict[str, float], monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Not even with every library below logging all it can."""
    import logging
    import traceback

    from pix2pred.images import ShownPictures
    from pix2pred.vlm import FlowSettings, Request, VLMError
    from pix2pred.vlm.hosted.client import HostedVLM
    from pix2pred.vlm.hosted.openai_compatible import OpenAICompatible
    from pix2pred.vlm.hosted.spec import hosted_model

    monkeypatch.setenv("PIX2PRED_API_KEY", KEY)
    caplog.set_level(logging.DEBUG)
    flow = FlowSettings(timeout=0.8 if "late" in rates else 60.0)
    with FaultServer(rates).running() as server:
        vlm = HostedVLM(hosted_model(OpenAICompatible(), f"tiny@{server.url}"), ShownPictures(), flow)
        if not rates:
            vlm.answer(Request(Purpose.LABEL, ("x",), 100))
        else:
            with pytest.raises(VLMError) as caught:
                vlm.answer(Request(Purpose.LABEL, ("x",), 100))
            error = caught.value
            assert error.__cause__ is None and error.__suppress_context__
            told = "".join(traceback.TracebackException.from_exception(error, capture_locals=False).format())
            assert KEY not in told and KEY not in repr(vars(error))
    assert caplog.records and all(KEY not in record.getMessage() + repr(record.args) for record in caplog.records)


def test_two_processes_on_one_store_ask_each_question_once_more_at_most(
    lamps: Path, quick: Path, tmp_path: Path
) -> None:
    with FaultServer(seconds=0.02).running() as server:
        options = ("learn", lamps, "--vlm", model(server), "--config", quick, "--answers", tmp_path / "store")
        both = [start(*options, "--out", tmp_path / name) for name in ("a", "b")]
        assert [p.wait() for p in both] == [0, 0]
        assert 24 <= len(server.bodies) <= 48
    one, other = ((tmp_path / name / "labels/traces.json").read_bytes() for name in ("a", "b"))
    assert one == other


def test_a_store_that_cannot_be_written_stops_before_anything_is_asked(
    cli: Cli, lamps: Path, server: FaultServer, quick: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import pix2pred.vlm.answers.store

    def refuse(folder: Path) -> None:  # a folder without rights would not stop a test that is root
        raise PermissionError(13, "Permission denied", str(folder))

    monkeypatch.setattr(pix2pred.vlm.answers.store, "check_writable", refuse)
    ran = cli(
        "learn",
        lamps,
        "--vlm",
        model(server),
        "--config",
        quick,
        "--out",
        tmp_path / "r",
        "--answers",
        tmp_path / "store",
    )
    assert ran.code == 2 and "nothing was asked" in ran.err and not server.bodies


def test_a_full_disk_ends_the_run_and_loses_nothing_stored(
    cli: Cli, lamps: Path, server: FaultServer, quick: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import pix2pred.system.files
    import pix2pred.vlm.answers.store

    whole, count = pix2pred.system.files.write_whole, [0]

    def full(path: Path, content: bytes) -> None:
        count[0] += 1
        if count[0] > 12:
            raise OSError(28, "No space left on device", str(path))
        whole(path, content)

    with monkeypatch.context() as patched:
        patched.setattr(pix2pred.vlm.answers.store, "write_whole", full)
        ran = cli("learn", lamps, "--vlm", model(server), "--config", quick, "--out", tmp_path / "run")
    assert ran.code == 2 and "No space left" in ran.err and "are safe" in ran.err
    stored = len(list((tmp_path / "run/answers").rglob("*.json")))
    before = len(server.bodies)
    assert cli("learn", lamps, "--vlm", model(server), "--config", quick, "--out", tmp_path / "run").code == 0
    assert len(server.bodies) - before == 24 - stored


@pytest.mark.parametrize("spec", ["http", "mailbox"])
def test_ctrl_c_ends_soon_and_the_run_goes_on_later(
    spec: str, cli: Cli, lamps: Path, quick: Path, tmp_path: Path
) -> None:
    with FaultServer(seconds=0.3).running() as server:
        name = model(server) if spec == "http" else f"mailbox:{tmp_path / 'box'}"
        process = start("learn", lamps, "--vlm", name, "--config", quick, "--out", tmp_path / "run")
        while len(server.bodies) < 6 and len(list((tmp_path / "box").glob("*/request.json"))) < 4:
            assert process.poll() is None
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=120) == 130
        if spec == "http":
            assert cli("learn", lamps, "--vlm", name, "--config", quick, "--out", tmp_path / "run").code == 0


def test_a_mailbox_is_answered_in_any_order_and_returns_what_it_cannot_read(
    cli: Cli, lamps: Path, tmp_path: Path
) -> None:
    box, done = tmp_path / "box", threading.Event()

    def person() -> None:
        """Answers the newest question first; spoils each first answer about d1, once by emptiness."""
        rng, spoiled = random.Random(1), set()
        while not done.is_set():
            waiting = [p.parent for p in box.glob("*/request.json") if not (p.parent / "answer.txt").exists()]
            for folder in rng.sample(waiting, len(waiting)):
                try:
                    prompt = (folder / "prompt.md").read_text()
                except FileNotFoundError:  # just filed
                    continue
                asked = prompt.rpartition("\nPredicates:\n")[2].partition("\n\n")[0].splitlines()
                good = "\n".join(f"{a}: {'True' if 'l1' in a else 'False'}" for a in asked)
                if "Write ground predicates" in prompt:
                    good = "lit(l1)"
                if folder.name.startswith("d1") and folder.name not in spoiled:
                    spoiled.add(folder.name)
                    good = "" if "propose" in folder.name else good.rpartition("\n")[0]
                (folder / "answer.txt").write_text(good)
            time.sleep(0.02)

    threading.Thread(target=person, daemon=True).start()
    ran = cli("learn", lamps, "--vlm", f"mailbox:{box}", "--out", tmp_path / "run")
    done.set()
    assert ran.code == 0, ran.err
    assert sorted(p.name for p in box.iterdir()) == ["OPEN.md", "README.md", "answered", "progress.json"]
    assert (box / "OPEN.md").read_text().startswith("# 0 questions wait; 24 were answered")
    answered = list((box / "answered").iterdir())
    assert len(answered) == 24
    returned = [p for p in answered if (p / "answer-returned-1.txt").exists()]
    assert returned and all(p.name.startswith("d1") for p in returned)
    assert [int(p.stem) for p in sorted((answered[0]).glob("*.png"))] == list(
        range(1, 1 + len(list(answered[0].glob("*.png"))))
    )
    again = cli("learn", lamps, "--vlm", f"mailbox:{box}", "--out", tmp_path / "another", "--json")
    assert again.code == 0, "answers given once are found again"


def test_what_a_model_says_cannot_command_the_terminal(cli: Cli, tmp_path: Path) -> None:
    """Titles, colours, clipboard writes, cleared screens and reordered text are shown instead of obeyed."""
    hostile = "* lit(l1)\n\x1b]0;owned\x07\x1b[2J\x1b]52;c;aGk=\x07\x9b31m\u202etxt.exe\r> ok\x00\tend"
    store = AnswerStore(tmp_path)
    store.put(Request(Purpose.PROPOSE, ("what?\x1b[31m",), 10), "m\x1b[1m", Answer(hostile))
    listed = cli("answers", "list", tmp_path).out
    shown = cli("answers", "show", tmp_path, store.all_keys()[0][:8]).out
    for text in (listed, shown):
        assert not set(text) & {*map(chr, range(9)), *map(chr, range(11, 32)), "\x7f", "\x9b", "\u202e"}
    assert "␛]0;owned" in shown and "what?␛[31m" in shown and "\\u202etxt.exe" in shown and "␍> ok" in shown


@pytest.mark.parametrize(
    "options",
    [("--vlm", "offline"), ("--mode", "live"), ("--max-cost", "1"), ("--dry-run",), ("--votes", "3"), ("--out", "x")],
)
def test_learning_again_refuses_options_it_cannot_obey(cli: Cli, tmp_path: Path, options: tuple[str, ...]) -> None:
    run = learn_lamps(tmp_path, "run")
    before = {p: p.read_bytes() for p in run.path.rglob("*") if p.is_file()}
    ran = cli("learn", "--resume", run.path, *options)
    assert ran.code == 2 and f"leave out {options[0]}" in ran.err
    assert {p: p.read_bytes() for p in run.path.rglob("*") if p.is_file()} == before


def test_a_long_list_ends_quietly_with_its_reader(tmp_path: Path) -> None:
    """``answers list STORE | head``: no message, no traceback, and lines come before the last answer was read."""
    store = AnswerStore(tmp_path)
    for n in range(1500):
        store.put(Request(Purpose.LABEL, (f"question {n}",), 10), "m", Answer("True. " * 20))
    program = [sys.executable, "-c", "from pix2pred.cli import main; main()", "answers", "list", str(tmp_path)]
    with subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        assert running.stdout is not None and running.stderr is not None
        assert b"  label          complete   m  True." in running.stdout.readline()
        running.stdout.close()
        assert running.stderr.read() == b""
        assert running.wait(60) == 1
