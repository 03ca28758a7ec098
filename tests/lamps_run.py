"""A run learned in a blink from a model that says hostile things, for tests of reports and reviews."""

from __future__ import annotations

import json
from pathlib import Path

from cli.hostile_lamps import Fake, sees, write_lamps
from pix2pred.demos import project_digest, read_project
from pix2pred.pipeline import LearningProblem
from pix2pred.report import write_report
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.learn import learn_into
from pix2pred.settings import of_project, resolve
from pix2pred.vlm import AnswerStore, Purpose, Request, StoredVLM

BOMB = "</script><script>window.boom=1</script><img src=x onerror=window.boom=2>"
"""What must never run, wherever it comes from."""


def _says(request: Request) -> str:
    if request.purpose == Purpose.PROPOSE:
        return "* lit(l1)\n* bright(l1)\n* near(robby, l2)\n* lit(ghost)\n"
    return sees(request).replace("As seen.", f"As seen {BOMB}")


def learn_lamps(
    root: Path, name: str = "run<img src=x onerror=boom>", demos: int = 2, descriptor: str = ""
) -> RunFolder:
    """A finished run with its report in ``root/name``. ``bright`` is never true, ``lit`` always right.

    ``descriptor`` is that of the robot.
    """
    data = write_lamps(root / "data", demos)
    if descriptor:
        sheet = (data / "domain.yaml").read_text()
        robot = f"robby: {{type: robot, descriptor: {json.dumps(descriptor)}}}"
        (data / "domain.yaml").write_text(sheet.replace("robby: {type: robot}", robot))
    project = read_project(data)
    settings = resolve(of_project(project.sections))
    model = Fake(_says, _says, f"fake{BOMB}")
    with RunFolder(root / name).locked() as run:
        run.claim(
            {
                "data": project_digest(project), "vlm": "fake", "model": model.name, "simulator": {},
                "settings": settings.model_dump(mode="json"), "answers": None,
            }
        )  # fmt: skip
        stored = StoredVLM(model, AnswerStore(run.path))
        learn_into(run, LearningProblem(project.vocabulary, project.demos, stored, settings))
        write_report(run)
    return run
