"""The mailbox in a browser: what the server shows and takes, and what a person does with keys and buttons."""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from browser import chromium
from extras import need
from pix2pred.images import ShownPictures
from pix2pred.review import MailboxServer
from pix2pred.vlm import Answer, Purpose, Request
from pix2pred.vlm.control.guard import Expected
from pix2pred.vlm.mailbox import MailboxVLM
from pix2pred.vlm.mailbox_folder import MailboxError, MailboxFolder
from review.test_server import ask
from vlm.real_servers import view
from vlm.test_mailbox import QUESTION, asking, awaited

HISTORY = replace(
    QUESTION,
    purpose=Purpose.HISTORY,
    parts=(
        "Meanings:\n- lit(lamp): the bulb gives light\n\nPredicates:\nlit(a)\nlit(b)",
        *(view(20 * t, t) for t in range(3)),
    ),
    about="d0, states 0 to 2",
)
PROPOSAL = replace(QUESTION, purpose=Purpose.PROPOSE, parts=("Name predicates.", view(20, 0)), about="d1")


def wait(box: MailboxVLM, request: Request) -> tuple[threading.Thread, list[Answer]]:
    answers: list[Answer] = []
    return asking(box, request, answers), answers


@pytest.fixture
def box(tmp_path: Path) -> Iterator[MailboxVLM]:
    made = MailboxVLM(tmp_path, ShownPictures(), poll=0.01, estimate=lambda: Expected(40, 4000, None))
    yield made
    made.stop()


@pytest.fixture
def server(tmp_path: Path) -> Iterator[MailboxServer]:
    with MailboxServer(MailboxFolder(tmp_path)) as made:
        threading.Thread(target=made.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True).start()
        yield made
        made.shutdown()


def test_a_question_is_shown_with_what_was_before_and_answered(
    box: MailboxVLM, server: MailboxServer, tmp_path: Path
) -> None:
    thread, answers = wait(box, QUESTION)
    awaited(tmp_path, "d0-*/request.json")
    base = f"/{server.token}"
    standing = ask(server, f"{base}/standing")[1]
    (name,) = standing["waiting"]
    assert (standing["answered"], standing["expected"], standing["seconds"]) == (0, 40, None)
    question = ask(server, f"{base}/question/{name}")[1]
    assert [(a["atom"], a["before"]) for a in question["atoms"]] == [("lit(a)", "True"), ("lit(b)", "")]
    assert question["states"] == [0] and question["about"] == "d0, state 1"
    status, problem = ask(server, f"{base}/answer/{name}", {"values": {"lit(a)": {"0": "False"}}})
    assert status == 400 and "lit(b)" in problem["error"] and not answers
    values = {"lit(a)": {"0": "False"}, "lit(b)": {"0": "Unknown"}}
    assert ask(server, f"{base}/answer/{name}", {"values": values})[0] == 200
    thread.join(120)
    assert answers == [Answer("* lit(a): False\n* lit(b): Unknown")]
    assert ask(server, f"{base}/standing")[1]["answered"] == 1


def test_values_of_many_states_are_written_as_changes(box: MailboxVLM, tmp_path: Path) -> None:
    thread, answers = wait(box, HISTORY)
    folder = MailboxFolder(tmp_path)
    name = awaited(tmp_path, "d0-*/request.json").parent.name
    question = folder.question(name)
    assert question.states == (0, 1, 2) and question.atoms[0].meaning == "the bulb gives light"
    lit = {"0": "False", "1": "True", "2": "True"}
    folder.answer(name, {"values": {"lit(a)": lit, "lit(b)": dict.fromkeys("012", "Unknown")}})
    thread.join(120)
    assert answers == [Answer("* lit(a): False; 1 True\n* lit(b): Unknown")]


def test_the_first_answer_is_what_a_double_check_begins_with(box: MailboxVLM, tmp_path: Path) -> None:
    quoted = f"<question>\n{QUESTION.text}\n</question>\n\n<answer>\n* lit(a): False. Dark.\n* lit(b): True\n</answer>"
    text = f"{quoted}\n\nPredicates:\nlit(a)\nlit(b)"
    wait(box, replace(QUESTION, purpose=Purpose.DOUBLE_CHECK, parts=(text, view(20, 0))))
    form = awaited(tmp_path, "d0-*/form.txt")
    assert form.read_text() == "* lit(a): False\n* lit(b): True\n"
    rows = MailboxFolder(tmp_path).question(form.parent.name).atoms
    assert [(r.before, r.said) for r in rows] == [("True", "False"), ("", "True")]


@pytest.mark.parametrize(
    "path",
    ["question/../secret", "question/nothing", "question/", "picture/{name}/request.json", "picture/{name}/../x.png",
     "picture/{name}/..%2f..%2fsecret%2f01.png", "picture//01.png", "picture/answered/01.png", "other", "question/%00"],
)  # fmt: skip
def test_nothing_but_questions_and_their_pictures_is_served(
    box: MailboxVLM, server: MailboxServer, tmp_path: Path, path: str
) -> None:
    (tmp_path / "secret").mkdir()
    (tmp_path / "secret/01.png").write_bytes(b"x")
    wait(box, QUESTION)
    name = awaited(tmp_path, "d0-*/request.json").parent.name
    assert ask(server, f"/{server.token}/{path.format(name=name)}")[0] == 404
    assert ask(server, f"/wrong/question/{name}")[0] == 403
    assert ask(server, f"/{server.token}/answer/nothing", {"text": "x"})[0] == 400
    assert not (tmp_path / "nothing").exists()


NONSENSE: list[Any] = [
    [], {}, {"values": []}, {"values": {"lit(a)": "True"}}, {"text": "x"}, {"values": {"lit(a)": {"0": 1}}}
]  # fmt: skip


@pytest.mark.parametrize("body", NONSENSE)
def test_nonsense_is_no_answer(box: MailboxVLM, server: MailboxServer, tmp_path: Path, body: Any) -> None:
    wait(box, QUESTION)
    folder = awaited(tmp_path, "d0-*/request.json").parent
    assert ask(server, f"/{server.token}/answer/{folder.name}", body)[0] in (400, 404)
    assert not (folder / "answer.txt").exists()


def test_pipes_links_and_damaged_files_hold_nothing_up(tmp_path: Path) -> None:
    folder = tmp_path / "q-label-1"
    folder.mkdir()
    (folder / "request.json").write_text(json.dumps({"about": "q", "purpose": "propose", "request": {"parts": ["x"]}}))
    os.mkfifo(folder / "problem.md")
    os.mkfifo(folder / "answer-returned-1.txt")
    os.mkfifo(tmp_path / "progress.json")
    (folder / "answer.txt").symlink_to("/dev/zero")
    box = MailboxFolder(tmp_path)
    assert box.standing().waiting == ("q-label-1",) and box.question("q-label-1").problem == ""
    box.answer("q-label-1", {"text": "wet(a)"})
    assert (folder / "answer.txt").read_text() == "wet(a)" and not (folder / "answer.txt").is_symlink()
    with pytest.raises(MailboxError, match="does not wait"):
        box.answer("q-label-1", {"text": "again"})


def test_an_answer_that_is_a_pipe_is_not_waited_for(box: MailboxVLM, tmp_path: Path) -> None:
    thread, answers = wait(box, QUESTION)
    folder = awaited(tmp_path, "d0-*/request.json").parent
    os.mkfifo(folder / "answer.txt")
    (folder / "good").write_text("* lit(a): True\n* lit(b): True")
    (folder / "good").replace(folder / "answer.txt")
    thread.join(120)
    assert len(answers) == 1


def test_questions_are_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    for name in ("d-state-10-label-a", "d-state-2-label-b", "c-propose-f"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "request.json").write_text("{}")
    waiting = MailboxFolder(tmp_path).standing().waiting
    assert waiting == ("c-propose-f", "d-state-2-label-b", "d-state-10-label-a")


@pytest.mark.parametrize(
    "content", ["{}", "[" * 100_000, "\x00", '{"request": {"parts": [7]}, "about": "", "purpose": ""}']
)
def test_a_damaged_question_is_named(server: MailboxServer, tmp_path: Path, content: str) -> None:
    (tmp_path / "q").mkdir()
    (tmp_path / "q/request.json").write_text(content)
    status, text = ask(server, f"/{server.token}/question/q")
    assert status == 404 and "q/request.json: is damaged" in text


@need("playwright", extra="browser")
def test_by_keyboard_and_by_mouse(box: MailboxVLM, server: MailboxServer, tmp_path: Path) -> None:
    (first, label), (second, history) = wait(box, QUESTION), wait(box, HISTORY)
    awaited(tmp_path, "d0-state-1-*/request.json")
    awaited(tmp_path, "d0-states-*/request.json")
    with chromium() as browser:
        page = browser.new_page()
        noise: list[str] = []
        page.on("console", lambda message: noise.append(message.text))
        page.on("pageerror", lambda error: noise.append(str(error)))
        page.goto(server.url)
        page.wait_for_selector("#about:text('d0, state 1')")
        assert page.locator("#progress").inner_text() == "0 of 40"
        assert page.locator("#send").is_disabled() and page.locator("#free").is_hidden()
        page.keyboard.press("b")  # as before: True
        page.keyboard.press("f")
        page.keyboard.press("Enter")
        first.join(120)
        assert label == [Answer("* lit(a): True\n* lit(b): False")]
        page.wait_for_selector("#about:text('d0, states 0 to 2')")
        page.get_by_role("radio", name="state 0: False").first.check()
        page.get_by_role("radio", name="state 2: True").first.check()
        page.get_by_role("radio", name="state 0: Unknown").last.check()
        page.get_by_role("button", name="Send").click()
        second.join(120)
        assert history == [Answer("* lit(a): False; 2 True\n* lit(b): Unknown")]
        third, proposal = wait(box, PROPOSAL)
        page.get_by_label("Your answer").fill("wet(a)")
        page.keyboard.press("Control+Enter")
        third.join(120)
        assert proposal == [Answer("wet(a)")]
        page.wait_for_selector("#idle:visible")
        assert noise == []
