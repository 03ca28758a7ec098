"""The mailbox: a form to fill in, a list of what waits."""

from __future__ import annotations

import threading
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from pix2pred.images import ShownPictures
from pix2pred.vlm import Answer, NoAnswerError, Purpose, Request
from pix2pred.vlm.mailbox import MailboxVLM
from vlm.real_servers import view

TEXT = "<previous>\n* lit(a): True. So it was.\n</previous>\n\nPredicates:\nlit(a)\nlit(b)"
QUESTION = Request(Purpose.LABEL, (TEXT, view(20, 0)), 100, about="d0, state 1")
AGES = 30.0


def asking(box: MailboxVLM, request: Request, answers: list[Answer]) -> threading.Thread:
    def ask() -> None:
        with suppress(NoAnswerError):  # the mailbox was stopped
            answers.append(box.answer(request))

    thread = threading.Thread(target=ask, daemon=True)
    thread.start()
    return thread


def awaited(folder: Path, pattern: str) -> Path:
    """The first file that fits, once it is there."""
    end = time.monotonic() + AGES
    while not (found := sorted(folder.glob(pattern))):
        assert time.monotonic() < end, f"no {pattern}"
        threading.Event().wait(0.01)
    return found[0]


def test_a_form_has_every_atom_with_the_value_before_and_is_an_answer_once_renamed(tmp_path: Path) -> None:
    answers: list[Answer] = []
    thread = asking(MailboxVLM(tmp_path, ShownPictures(), poll=0.01), QUESTION, answers)
    form = awaited(tmp_path, "d0-state-1-label-*/form.txt")
    assert form.read_text() == "* lit(a): True\n* lit(b): ?\n"
    awaited(tmp_path, "OPEN.md")
    form.write_text(form.read_text().replace("?", "False"))
    form.rename(form.with_name("answer.txt"))
    thread.join(AGES)
    assert answers == [Answer("* lit(a): True\n* lit(b): False")]
    assert (tmp_path / "OPEN.md").read_text().startswith("# 0 questions wait; 1 were answered")


def test_what_waits_is_listed_and_proposals_have_no_form(tmp_path: Path) -> None:
    box = MailboxVLM(tmp_path, ShownPictures(), poll=0.01)
    threads = [asking(box, QUESTION, []), asking(box, replace(QUESTION, purpose=Purpose.PROPOSE, about="d1"), [])]
    awaited(tmp_path, "d1-propose-*/request.json")
    awaited(tmp_path, "d0-state-1-label-*/request.json")
    end = time.monotonic() + AGES
    while not awaited(tmp_path, "OPEN.md").read_text().startswith("# 2 questions wait"):
        assert time.monotonic() < end
    assert "d0-state-1-label-" in (tmp_path / "OPEN.md").read_text()
    assert not list(tmp_path.glob("d1-propose-*/form.txt"))
    box.stop()
    for thread in threads:
        thread.join(AGES)
