"""Models that answer garbage or fail: nothing is invented, nothing is lost."""

from __future__ import annotations

import errno
import json
import re
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from cli.hostile import FailsAt, Model, always, refused, said, sees, tree, whole
from command_line import Cli
from pix2pred.predicates.labelling.parse_labels import parse_labels
from pix2pred.vlm import Request, VLMError

NO_PROPOSALS = {
    "empty": "",
    "prose": "I am sorry, but as a language model I cannot see (or imagine) the lamps.",
    "html": "<html><body onload='f()'><h1>502 Bad Gateway</h1></body></html>",
    "1 MB": "blah (" * 170_000,
    "rejected": "lit(ghost), near(l1, l1), on()",
    "control": "\x00\x1b[2J\ud800lit(\x07l1)",
}


@pytest.mark.parametrize("answer", NO_PROPOSALS.values(), ids=NO_PROPOSALS)
def test_no_usable_proposal_is_an_error(cli: Cli, model: Model, data: Path, tmp_path: Path, answer: str) -> None:
    model(propose=always(answer))
    refused(cli("learn", data, "--out", tmp_path / "run"), "fake:1", "no usable predicate")
    assert not (tmp_path / "run" / "model").exists()
    whole(tmp_path / "run")


def test_the_rejected_atoms_are_where_the_message_says(cli: Cli, model: Model, data: Path, tmp_path: Path) -> None:
    model(propose=always("lit(ghost)"))
    refused(cli("learn", data, "--out", tmp_path / "run"), "rejected atoms in the run folder")
    proposals = json.loads((tmp_path / "run" / "proposals.json").read_text())
    assert proposals[0]["rejected"][0]["text"] == "lit(ghost)"


@pytest.mark.parametrize("length", [101, 400, 5000])
@pytest.mark.parametrize("atom", ["{}(l1)", "lit({})", "lit(l1, {})"])
def test_names_too_long_for_files_are_rejected_before_anything_is_paid_for(
    cli: Cli, model: Model, data: Path, tmp_path: Path, length: int, atom: str
) -> None:
    model(propose=lambda r: sees(r) + "* " + atom.format("a" * length))
    ran = cli("learn", data, "--out", tmp_path / "run")
    assert ran.code == 0, ran.err
    (rejected, *_) = json.loads((tmp_path / "run" / "proposals.json").read_text())[0]["rejected"]
    assert f"a name of {length:,} characters" in rejected["reason"] and len(rejected["text"]) < 120


def test_a_name_of_the_most_characters_is_used(cli: Cli, model: Model, data: Path, tmp_path: Path) -> None:
    model(propose=lambda r: sees(r) + f"* {'a' * 100}(l1)\n* {'a' * 100}(robby)")
    assert cli("learn", data, "--out", tmp_path / "run").code == 0


NO_LABELS: dict[str, Callable[[Request], str]] = {
    "html": always("<html>502 Bad Gateway</html>"),
    "swahili": lambda r: sees(r).replace("True", "Kweli").replace("False", "Uongo"),
    "invented": always("* burning(l1): True\n* lit(l9): True"),
}


@pytest.mark.parametrize("answer", NO_LABELS.values(), ids=NO_LABELS)
def test_answers_without_a_single_label_are_never_taken_for_false(
    cli: Cli, model: Model, data: Path, tmp_path: Path, answer: Callable[[Request], str]
) -> None:
    """A failure is never an empty set (design 6.8): at the least the user must be told, in so many words."""
    model(label=answer)
    ran = cli("learn", data, "--out", tmp_path / "run")
    assert ran.code in (1, 2) or "unusable" in said(ran) + ran.out


@pytest.mark.parametrize("value", ["True", "Unknown", "both"])
def test_labels_that_say_nothing_are_counted(cli: Cli, model: Model, data: Path, tmp_path: Path, value: str) -> None:
    def label(request: Request) -> str:
        if value == "both":
            return sees(request) + "\n" + sees(request).replace("False", "True")
        return re.sub("True|False", value, sees(request))

    model(label=label)
    ran = cli("learn", data, "--out", tmp_path / "run", "--json")
    assert ran.code == 0, ran.err
    assert ran.json["unknown_labels"] == (24 if value == "Unknown" else 0)


def test_order_repeats_and_gaps_in_an_answer_change_nothing_they_should_not(
    cli: Cli, model: Model, data: Path, done: Path, tmp_path: Path
) -> None:
    def label(request: Request) -> str:
        lines = sees(request).splitlines()[::-1]
        return (
            "\n".join([*lines, "* burning(l1): True", *lines]).upper().replace("LIT(", "lit(").replace("NEAR(", "near(")
        )

    model(label=lambda r: label(r).replace("L1", "l1").replace("L2", "l2").replace("ROBBY", "robby"))
    assert cli("learn", data, "--out", tmp_path / "run").code == 0
    traces = [json.loads((f / "labels/traces.json").read_text()) for f in (done, tmp_path / "run")]
    assert traces[0]["demos"] == traces[1]["demos"]


def test_a_long_answer_on_one_line_is_read_in_reasonable_time() -> None:
    begin = time.process_time()
    assert parse_labels("lit(l1): True, " * 30_000, ["lit(l1)"]).values == {"lit(l1)": 1}
    assert time.process_time() - begin < 5


@pytest.mark.parametrize("n", [1, 3, 12])
def test_a_model_that_fails_at_any_query_can_be_resumed(
    cli: Cli, model: Model, data: Path, done: Path, tmp_path: Path, n: int
) -> None:
    fails = FailsAt(n, VLMError("the quota is used up; wait an hour"))
    model(propose=fails, label=fails)
    refused(cli("learn", data, "--out", tmp_path / "run"), "the quota is used up")
    whole(tmp_path / "run")
    stored = len(list((tmp_path / "run").glob("answers/*/*.json")))
    fake = model()
    assert cli("learn", data, "--out", tmp_path / "run").code == 0
    assert len(fake.asked) == 12 - stored
    assert tree(tmp_path / "run") == tree(done)


@pytest.mark.parametrize("error", [TimeoutError("timed out"), ConnectionResetError(errno.ECONNRESET, "reset by peer")])
def test_network_trouble_is_no_traceback(cli: Cli, model: Model, data: Path, tmp_path: Path, error: Exception) -> None:
    model(propose=FailsAt(1, error))
    refused(cli("learn", data, "--out", tmp_path / "run"))


def test_a_bug_in_a_model_loses_nothing(cli: Cli, model: Model, data: Path, done: Path, tmp_path: Path) -> None:
    fails = FailsAt(7, ZeroDivisionError("a bug"))
    model(propose=fails, label=fails)
    with pytest.raises(ZeroDivisionError):
        cli("learn", data, "--out", tmp_path / "run")
    whole(tmp_path / "run")
    model()
    assert cli("learn", data, "--out", tmp_path / "run").code == 0
    assert tree(tmp_path / "run") == tree(done)
