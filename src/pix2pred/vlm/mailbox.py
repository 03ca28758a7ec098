"""A mailbox: questions as folders, answered by hand or by a model behind a chat window.

    DIR/README.md                      how to answer
    DIR/OPEN.md                        what waits, and how many were answered
    DIR/progress.json                  how many questions a dry run expects in all
    DIR/demo-0-state-1-label-1f3a9c20/ one question: prompt.md, 01.png, 02.png, ..., request.json
        form.txt                       for labels: every atom with the value it had before, to correct and rename
        answer.txt                     the answer, put there by a person
        problem.md                     what was wrong with an answer; that answer is now answer-returned-1.txt
    DIR/answered/                      questions whose answer was taken

Any number of questions wait at once; answers are taken in any order, also after days: the same question goes into
the same folder, and a run that is started again finds what was answered meanwhile.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import threading
from dataclasses import dataclass
from pathlib import Path

from pix2pred.system.files import write_whole
from pix2pred.vlm.control.guard import Estimate
from pix2pred.vlm.mailbox_folder import ANSWER, ANSWERED, MOST_BYTES, PROGRESS, form
from pix2pred.vlm.model_spec import Draw, Kind, ModelSpec, Setup
from pix2pred.vlm.request import VLM, Answer, NoAnswerError, Purpose, Request, VLMError

_README = """# Questions waiting for an answer

`pix2pred mailbox DIR --open` shows them in a browser, with buttons for the answers. By hand, every folder here is one
question. To answer it:

1. Open `prompt.md`. It says everything, and shows the pictures `01.png`, `02.png`, ... in their order. To ask a model
   in a chat window, give it the pictures in this order and the text of `prompt.md`.
2. Write the answer into a file `answer.txt` in the same folder, in the form the question asks for. For labels,
   `form.txt` has a line for every atom, with the value it had before: look at the pictures, change what changed, write
   True, False or Unknown for every `?`, and rename the file to `answer.txt`.
   Write it under another name and rename it, or simply save it: it is read once it has stopped changing.
3. If the folder stays and a file `problem.md` appears, it says what was wrong; write `answer.txt` anew.

`OPEN.md` lists what waits. Answered folders move to `answered/`. New questions appear as answers come in, because a
question about a state holds the answer about the state before. You can stop the program (Ctrl-C) and run the same
command again days later.
"""


@dataclass(frozen=True, slots=True)
class MailboxSpec(ModelSpec):
    """A person, or whoever answers through a folder."""

    directory: Path

    def connect(self, setup: Setup) -> VLM:
        return MailboxVLM(self.directory, setup.draw, estimate=setup.spending.estimate)

    @property
    def waits_in(self) -> Path:
        return self.directory


MAILBOX = Kind("mailbox:DIR", lambda rest: MailboxSpec(Path(rest)))


class MailboxVLM:
    """Implements ``VLM``: puts a question into a folder and waits until a usable answer lies beside it."""

    def __init__(self, directory: Path, draw: Draw, *, poll: float = 0.5, estimate: Estimate | None = None) -> None:
        self.name = "mailbox"
        self._estimate = estimate
        self._estimated: set[bool] = set()
        self._directory = directory
        self._draw = draw
        self._poll = poll
        self._stopped = threading.Event()
        self._listing = threading.Lock()

    def answer(self, request: Request) -> Answer:
        """Wait for the answer, however long it takes. Raises ``VLMError`` when the folder cannot be used."""
        name = _folder_name(request, self.name)
        try:
            self._reckon(request)
            earlier = self._directory / ANSWERED / name / ANSWER
            if earlier.is_file() and not _problem(request, text := _read(earlier)):
                return Answer(text)
            folder = self._post(name, request)
            text = self._wait(folder, request)
            self._file(folder)
        except OSError as error:
            raise VLMError(f"mailbox: {error.filename or self._directory}: {error.strerror or error}") from error
        return Answer(text)

    def stop(self) -> None:
        """End all waiting: the run is over."""
        self._stopped.set()

    def _reckon(self, request: Request) -> None:
        """Write down how many questions there will be: before the first, and when the proposals are known."""
        proposing = request.purpose in (Purpose.PROPOSE, Purpose.DEFINE)
        with self._listing:
            if self._estimate is None or proposing in self._estimated:
                return
            self._estimated.add(proposing)
            answered = sum(1 for _ in (self._directory / ANSWERED).glob("*/request.json"))
            if (left := self._estimate()) is not None:
                document = json.dumps({"expected": answered + left.questions})
                write_whole(self._directory / PROGRESS, document.encode())

    def _post(self, name: str, request: Request) -> Path:
        """The question's folder, which appears complete or not at all."""
        folder = self._directory / name
        if not (self._directory / "README.md").exists():
            write_whole(self._directory / "README.md", _README.encode())
        if not (folder / "request.json").exists():
            part = self._directory / f".{name}.{os.getpid()}.part"
            shutil.rmtree(part, ignore_errors=True)
            part.mkdir(parents=True)
            lines = []
            for number, item in enumerate(request.parts):
                if isinstance(item, str):
                    lines.append(item)
                    continue
                picture = f"{sum(not isinstance(p, str) for p in request.parts[: number + 1]):02}.png"
                (part / picture).write_bytes(self._draw(item))
                lines.append(f"![{item.heading or picture}]({picture})")
            (part / "prompt.md").write_text("\n\n".join(lines) + "\n", encoding="utf-8")
            if request.purpose in (Purpose.LABEL, Purpose.DOUBLE_CHECK):
                (part / "form.txt").write_text(form(request.text), encoding="utf-8")
            document: dict[str, object] = {
                "key": request.key(self.name),
                "about": request.about,
                "purpose": request.purpose,
            }
            document |= {"request": request.canonical(self.name)}
            (part / "request.json").write_text(json.dumps(document, indent=1), encoding="utf-8")
            shutil.rmtree(folder, ignore_errors=True)  # without request.json it is not a question
            part.rename(folder)
        self._tell_what_is_open()
        return folder

    def _tell_what_is_open(self) -> None:
        """Bring the list of what waits up to date."""
        with self._listing:
            waiting = sorted(p.parent.name for p in self._directory.glob("*/request.json"))
            answered = sum(1 for _ in (self._directory / ANSWERED).glob("*/request.json"))
            lines = "".join(f"- [{name}]({name}/prompt.md)\n" for name in waiting)
            text = f"# {len(waiting)} questions wait; {answered} were answered\n\n{lines}"
            write_whole(self._directory / "OPEN.md", text.encode())

    def _wait(self, folder: Path, request: Request) -> str:
        path, seen = folder / ANSWER, None
        while True:
            found = path.stat() if path.is_file() else None
            state = (found.st_mtime_ns, found.st_size) if found else None
            if state is not None and state == seen:
                text = _read(path)
                problem = _problem(request, text)
                if not problem:
                    return text
                self._return(folder, problem)
            seen = state
            if self._stopped.wait(self._poll):
                raise NoAnswerError("the run was ended while this question waited in the mailbox")

    def _return(self, folder: Path, problem: str) -> None:
        number = 1 + sum(1 for _ in folder.glob("answer-returned-*.txt"))
        returned = f"answer-returned-{number}.txt"
        (folder / ANSWER).rename(folder / returned)
        text = (
            f"# This answer could not be used\n\n{problem}\n\n"
            f"The answer is now `{returned}`. Correct it and save it as `answer.txt`.\n"
        )
        write_whole(folder / "problem.md", text.encode())

    def _file(self, folder: Path) -> None:
        (folder / "problem.md").unlink(missing_ok=True)
        target = self._directory / ANSWERED / folder.name
        target.parent.mkdir(exist_ok=True)
        shutil.rmtree(target, ignore_errors=True)
        folder.rename(target)
        self._tell_what_is_open()


def _folder_name(request: Request, model: str) -> str:
    about = re.sub(r"[^a-z0-9]+", "-", request.about.lower()).strip("-")[:60]
    return "-".join(part for part in (about, request.purpose, request.key(model)[:8]) if part)


def _read(path: Path) -> str:
    with path.open("rb") as file:
        return file.read(MOST_BYTES).decode("utf-8", errors="replace").removeprefix("\ufeff").strip()


def _problem(request: Request, text: str) -> str:
    if not text:
        return "The answer is empty."
    review = request.review(text) if request.review else None
    return review.problem if review else ""
