"""``learn``: from a project folder to a run folder with a world model."""

from __future__ import annotations

import os
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from pix2pred.cli.console import UsageError, bars, err, print_estimated, print_json, print_learned
from pix2pred.cli.estimating import estimated, expected, project_settings
from pix2pred.cli.ranges import DOLLARS, NOT_NEGATIVE, WORKERS, between, output_folder, quoted
from pix2pred.demos import Project, join_projects, project_digest, read_project
from pix2pred.pipeline import LearningProblem
from pix2pred.registry import MODEL_FORMS, NO_LIMITS, Registry
from pix2pred.report import REPORT, write_report
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.layout import CONFIG
from pix2pred.runs.learn import learn_into, relearn, run_config
from pix2pred.settings import Layer, Settings, as_begun, of_file, of_options
from pix2pred.vlm import AnswerStore, StoreMode
from pix2pred.vlm.model_spec import ModelSpec, Spending


@dataclass(frozen=True, slots=True)
class ModelToAsk:
    """Which model is asked, where its answers are kept, and what may be spent."""

    vlm: str = "offline"
    answers: Path | None = None
    mode: StoreMode = StoreMode.RESUME
    limits: Spending = NO_LIMITS


@dataclass(frozen=True)
class AskingOptions:
    """Options of ``learn`` about asking the model; None stands for one not given."""

    vlm: Annotated[str | None, Parameter(help=f"Model that proposes and labels: {MODEL_FORMS} [default: offline].")] = (
        None
    )
    answers: Annotated[Path | None, Parameter(help="Answer store to share between runs [default: OUT].")] = None
    mode: Annotated[
        StoreMode | None,
        Parameter(
            help="live: ask; resume: ask what is not stored; retry: also what was refused or cut short; "
            "replay: never ask [default: resume]."
        ),
    ] = None
    votes: Annotated[
        int | None, Parameter(help="Samples per labelling query; the majority decides.", validator=between(1, 99))
    ] = None
    concurrent: Annotated[int | None, Parameter(help="Requests under way at once.", validator=WORKERS)] = None
    max_wait: Annotated[
        float | None,
        Parameter(help="Seconds to wait at most when a server says so [default: 600].", validator=between(0, 86_400)),
    ] = None
    longest_side: Annotated[
        int | None,
        Parameter(
            help="Pixels of the longer side of the pictures a model is shown [default: 512].",
            validator=between(64, 4096),
        ),
    ] = None
    max_requests: Annotated[int | None, Parameter(help="Most requests to send.", validator=NOT_NEGATIVE)] = None
    max_cost: Annotated[
        float | None, Parameter(help="Stop before spending more US dollars than this.", validator=DOLLARS)
    ] = None

    @property
    def asking(self) -> ModelToAsk:
        """The model, its answer store and what may be spent."""
        limits = Spending(self.max_requests, self.max_cost)
        return ModelToAsk(self.vlm or "offline", self.answers, self.mode or StoreMode.RESUME, limits)

    @property
    def settings(self) -> Layer:
        """Those of the options that are settings of a run."""
        return of_options(
            {
                ("labels", "votes"): self.votes,
                ("flow", "concurrent"): self.concurrent,
                ("flow", "max_wait"): self.max_wait,
                ("labels", "longest_side"): self.longest_side,
                ("proposal", "longest_side"): self.longest_side,
            }
        )


DEFAULT = AskingOptions()


def learn(
    *data: Annotated[Path, Parameter(help="Project folders with demonstrations; several are learned from together.")],
    out: Annotated[
        Path | None, Parameter(help="Run folder; the same command resumes an interrupted run.", validator=output_folder)
    ] = None,
    resume: Annotated[
        Path | None, Parameter(help="Learn again in this finished run, with its corrections; asks no model.")
    ] = None,
    config: Annotated[Path | None, Parameter(help="YAML file with settings that differ from the defaults.")] = None,
    options: Annotated[AskingOptions, Parameter(name="*")] = DEFAULT,
    dry_run: Annotated[bool, Parameter(help="Print what would be asked and what it may cost; ask nothing.")] = False,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
    registry: Annotated[Registry, Parameter(parse=False)],
) -> int:
    """Learn a world model from the demonstrations in project folders.

    For example:

    - `pix2pred learn data/stacks --vlm offline --out runs/stacks`
    - `pix2pred learn --resume runs/stacks`
    - `pix2pred learn data/tea --vlm openai:gpt-4o --out runs/tea --dry-run`
    - `pix2pred learn data/monday data/tuesday --vlm openai:gpt-4o --out runs/both`
    - `pix2pred learn data/tea --vlm openai-compatible:qwen2.5-vl@http://localhost:8000/v1 --out runs/tea`
    - `pix2pred learn data/tea --vlm mailbox:inbox --out runs/tea`
    """
    if resume is not None:
        given = {"DATA": data or None, "--out": out, "--config": config, "--dry-run": dry_run or None}
        given |= {f"--{f.name.replace('_', '-')}": getattr(options, f.name) for f in fields(options)}
        _learn_again(resume, [name for name, value in given.items() if value is not None], as_json=json)
        return 0
    if not data or out is None:
        raise UsageError("name the data and a run folder: pix2pred learn DATA --out RUN")
    for folder in data:
        if any(out.resolve().is_relative_to((folder / part).resolve()) for part in ("demos", "tasks")):
            raise UsageError(f"--out {out}: lies among the demonstrations and tasks; choose a folder of its own")
    project = join_projects(data, [read_project(folder) for folder in data])
    begun = [as_begun(RunFolder(out).config())] if (out / CONFIG).is_file() else []
    settings = project_settings(project, *([of_file(config)] if config else []), options.settings, begun=begun)
    asking = options.asking
    if dry_run:
        estimate = estimated(registry, project, settings, asking.vlm, AnswerStore(asking.answers or out))
        print_json(estimate) if json else print_estimated(estimate)
        return 0
    metrics = run_learning(registry, project, settings, asking, out, quiet=json)
    if json:
        print_json(metrics)
    else:
        err.print(f"run folder: {out}\nreport: {out / REPORT}", markup=False)
    return 0


def run_learning(
    registry: Registry, project: Project, settings: Settings, asking: ModelToAsk, out: Path, *, quiet: bool
) -> dict[str, Any]:
    """Learn into the run folder ``out`` with progress bars; gives the summary."""
    domain = (project.simulator or {}).get("domain")
    store = AnswerStore(asking.answers or out)
    store.check()
    limits = replace(asking.limits, estimate=lambda: expected(registry, project, settings, asking.vlm, store))
    model = registry.stored(asking.vlm, domain, store, asking.mode, settings.flow, limits)
    with RunFolder(out).locked() as run:
        problem = LearningProblem(project.vocabulary, project.demos, model, settings)
        digest = project_digest(project)
        run.claim(run_config(problem, digest, asking.vlm, out, project.simulator, asking.answers))
        say_where_questions_wait(registry.model_spec(asking.vlm))
        with bars() as progress:
            learned = learn_into(run, replace(problem, progress=progress))
        write_report(run)
    if not quiet:
        print_learned(learned.metrics, learned.selected.model.operators)
        err.print(learned.usage, markup=False)
    return learned.metrics


def say_where_questions_wait(model: ModelSpec) -> None:
    """Say where questions wait, if the model is a person."""
    if model.waits_in is not None:
        place = model.waits_in.resolve()
        shown = Path(min(str(place), os.path.relpath(place), key=len))
        err.print(
            f"Questions wait for answers in {shown}. In another terminal:\n  pix2pred mailbox {quoted(shown)} --open\n"
            "(or by hand: its README.md says how). Ctrl-C stops; the same command goes on.",
            markup=False,
            soft_wrap=True,
        )


def _learn_again(folder: Path, unused: list[str], *, as_json: bool) -> None:
    """Learn again in a finished run with progress bars."""
    if unused:
        raise UsageError(
            f"--resume RUN asks no model and takes everything from the run folder; leave out {', '.join(unused)}"
            ", or learn into a new folder with --out"
        )
    RunFolder(folder).config()
    with RunFolder(folder).locked() as run:
        with bars() as progress:
            learned = relearn(run, progress)
        write_report(run)
    if as_json:
        print_json(learned.metrics)
    else:
        print_learned(learned.metrics, learned.selected.model.operators)
