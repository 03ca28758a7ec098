"""What happens while a run is reviewed: corrections come in, and now and then somebody learns again."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from typing import Any

from pydantic import TypeAdapter, ValidationError

from pix2pred.learning import load_traces
from pix2pred.predicates import Corrections, CorrectionsError
from pix2pred.predicates.correction_rows import Row, parse_row
from pix2pred.report import load_contents, write_report
from pix2pred.report.page import as_json
from pix2pred.review.log import CorrectionLog, now
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.layout import AS_SAID
from pix2pred.runs.learn import LearnedRun, relearn
from pix2pred.system.progress import Progress, Stage

_BODY: TypeAdapter[list[dict[str, Any]]] = TypeAdapter(list[dict[str, Any]])

LearnAgain = Callable[[RunFolder, Progress], LearnedRun]
"""What the page's button does to a run."""


class ReviewSession:
    """The corrections and the learning of one run; methods may be called from any thread."""

    def __init__(self, run: RunFolder, learn_again: LearnAgain = relearn) -> None:
        load_contents(run)  # raises for a run that cannot be shown
        self.run = run
        self._learn_again = learn_again
        self.log = CorrectionLog(run.path, load_traces(run.path / AS_SAID).table)
        self._lock = threading.Lock()
        self._learning = ""
        self._error = ""
        self._learned = 0

    def state(self) -> dict[str, Any]:
        """The corrections in force and how learning is going; ``version`` counts finished learnings."""
        rows = self.log.rows()
        corrections = Corrections.of(rows)
        with self._lock:
            learning = {"running": self._learning, "error": self._error, "version": self._learned}
        return {"corrections": as_json(corrections), "learning": learning}

    def correct(self, body: Any) -> dict[str, Any]:
        """Append the rows in ``body``, dated now; gives the new state."""
        try:
            entries = _BODY.validate_python(body)
        except ValidationError as error:
            raise CorrectionsError("expected a list of corrections") from error
        rows: list[Row] = [parse_row(json.dumps({**entry, "when": now()})) for entry in entries]
        self.log.append(rows)
        return self.state()

    def learn(self) -> dict[str, Any]:
        """Begin to learn again, unless that is going on already; gives the state."""
        with self._lock:
            if not self._learning:
                self._learning, self._error = "starting", ""
                threading.Thread(target=self._learn, daemon=True).start()
        return self.state()

    def _learn(self) -> None:
        def progress(stage: Stage, done: int, total: int, text: str) -> None:
            with self._lock:
                self._learning = f"{stage} {done} of {total}"

        error = ""
        try:
            with self.run.locked() as run:
                self._learn_again(run, progress)
                with self._lock:
                    self._learning = "writing the report"
                write_report(run)
        except Exception as problem:  # whatever it is, the page has to say it instead of waiting for ever
            error = str(problem) or type(problem).__name__
        with self._lock:
            self._learning, self._error = "", error
            self._learned += not error
