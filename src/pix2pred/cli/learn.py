"""``learn``: from a project folder to a run folder with a world model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import yaml
from cyclopts import Parameter
from pydantic import ValidationError

from pix2pred.cli.console import NOT_NEGATIVE, POSITIVE, bars, err, print_estimated, print_json, print_learned
from pix2pred.demos import Project, project_digest, read_project
from pix2pred.pipeline import Settings, ask_everything
from pix2pred.registry import NO_LIMITS, Limits, RegistryError, load_estimator, load_stored
from pix2pred.report import REPORT, write_report
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.learn import learn_into, relearn
from pix2pred.vlm import AnswerStore, CountingVLM, StoreMode
from pix2pred.vlm.model_spec import FORMS


def learn(
    data: Path | None = None,
    /,
    *,
    out: Annotated[Path | None, Parameter(help="Run folder; the same command resumes an interrupted run.")] = None,
    resume: Annotated[
        Path | None, Parameter(help="Learn again in this finished run, with its corrections; asks no model.")
    ] = None,
    vlm: Annotated[str | None, Parameter(help=f"Model that proposes and labels: {FORMS} [default: offline].")] = None,
    config: Annotated[Path | None, Parameter(help="YAML file with settings that differ from the defaults.")] = None,
    answers: Annotated[Path | None, Parameter(help="Answer store to share between runs [default: OUT].")] = None,
    mode: Annotated[
        StoreMode | None,
        Parameter(
            help="live: ask; resume: ask what is not stored; retry: also what was refused or cut short; "
            "replay: never ask [default: resume]."
        ),
    ] = None,
    votes: Annotated[int | None, Parameter(help="Samples per labelling query; the majority decides.")] = None,
    concurrent: Annotated[int | None, Parameter(help="Requests under way at once.", validator=POSITIVE)] = None,
    longest_side: Annotated[
        int | None, Parameter(help="Pixels of the longer side of the pictures a model is shown [default: 512].")
    ] = None,
    max_requests: Annotated[int | None, Parameter(help="Most requests to send.", validator=NOT_NEGATIVE)] = None,
    max_cost: Annotated[float | None, Parameter(help="Stop before spending more US dollars than this.")] = None,
    dry_run: Annotated[bool, Parameter(help="Print what would be asked and what it may cost; ask nothing.")] = False,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
) -> int:
    """Learn a world model from the demonstrations in a project folder.

    Examples: pix2pred learn data/stacks --vlm offline --out runs/stacks
    pix2pred learn --resume runs/stacks
    pix2pred learn data/tea --vlm openai:gpt-4o --out runs/tea --dry-run
    pix2pred learn data/tea --vlm openai-compatible:qwen2.5-vl@http://localhost:8000/v1 --out runs/tea
    pix2pred learn data/tea --vlm mailbox:inbox --out runs/tea
    """
    if resume is not None:
        given = {
            "DATA": data, "--out": out, "--vlm": vlm, "--config": config, "--answers": answers, "--mode": mode,
            "--votes": votes, "--concurrent": concurrent, "--max-requests": max_requests, "--max-cost": max_cost,
            "--dry-run": dry_run or None,
        }  # fmt: skip
        unused = [name for name, value in given.items() if value is not None]
        if unused:
            raise RegistryError(
                f"--resume RUN asks no model and takes everything from the run folder; leave out {', '.join(unused)}"
                ", or learn into a new folder with --out"
            )
        metrics = run_relearning(resume, quiet=json)
        if json:
            print_json(metrics)
        return 0
    if data is None or out is None:
        raise RegistryError("name the data and a run folder: pix2pred learn DATA --out RUN")
    if any(out.resolve().is_relative_to((data / part).resolve()) for part in ("demos", "tasks")):
        raise RegistryError(f"--out {out}: lies among the demonstrations and tasks; choose a folder of its own")
    project = read_project(data)
    settings = resolve_settings(project, config, votes, concurrent, longest_side)
    vlm, mode = vlm or "offline", mode or StoreMode.RESUME
    if dry_run:
        return print_estimate(project, settings, vlm, AnswerStore(answers or out), as_json=json)
    metrics = run_learning(project, settings, vlm, out, answers, mode, Limits(max_requests, max_cost), quiet=json)
    if json:
        print_json(metrics)
    else:
        err.print(f"run folder: {out}\nreport: {out / REPORT}", markup=False)
    return 0


def run_learning(
    project: Project,
    settings: Settings,
    vlm: str,
    out: Path,
    answers: Path | None,
    mode: StoreMode,
    limits: Limits = NO_LIMITS,
    *,
    quiet: bool,
) -> dict[str, Any]:
    """Learn into the run folder ``out`` with progress bars; gives the summary."""
    domain = (project.simulator or {}).get("domain")
    store = AnswerStore(answers or out)
    store.check()
    model = load_stored(vlm, domain, store, mode, settings.flow, limits)
    with RunFolder(out).locked() as run:
        run.claim(
            {
                "data": project_digest(project),
                "vlm": vlm,
                "model": model.name,
                "simulator": dict(project.simulator or {}),
                "settings": settings.model_dump(mode="json", exclude={"flow"}),  # how to ask changes no result
                "answers": str(answers.resolve()) if answers else None,
            }
        )
        counting = CountingVLM(model)
        if vlm.startswith("mailbox:"):
            folder = vlm.partition(":")[2]
            err.print(f"Questions wait for answers in {folder}; its README.md says how. Ctrl-C stops.", markup=False)
        with bars() as progress:
            learned, metrics = learn_into(run, project.vocabulary, project.demos, counting, settings, progress)
        write_report(run)
    if not quiet:
        print_learned(metrics, learned.model.operators)
        err.print(counting.usage.line(), markup=False)
    return metrics


def run_relearning(folder: Path, *, quiet: bool) -> dict[str, Any]:
    """Learn again in a finished run with progress bars; gives the summary."""
    RunFolder(folder).config()
    with RunFolder(folder).locked() as run:
        with bars() as progress:
            selected, metrics = relearn(run, progress)
        write_report(run)
    if not quiet:
        print_learned(metrics, selected.model.operators)
    return metrics


def print_estimate(project: Project, settings: Settings, vlm: str, store: AnswerStore, *, as_json: bool) -> int:
    """What a run would ask."""
    estimator = load_estimator(vlm, (project.simulator or {}).get("domain"), store)
    ask_everything(project.vocabulary, project.demos, estimator, settings)
    estimate = estimator.as_dict()
    if as_json:
        print_json(estimate)
    else:
        print_estimated(estimate)
    return 0


def resolve_settings(
    project: Project,
    config: Path | None,
    votes: int | None = None,
    concurrent: int | None = None,
    longest_side: int | None = None,
) -> Settings:
    """Defaults, overridden by the project's ``learning`` section, by ``config``, and by options."""
    given: dict[str, Any] = {"learning": dict(project.learning)}
    if config is not None:
        try:
            loaded = yaml.safe_load(config.read_text(encoding="utf-8")) or {}
        except (ValueError, yaml.YAMLError) as error:
            raise RegistryError(f"{config}: cannot be read as YAML ({' '.join(str(error).split())[:200]})") from error
        if not isinstance(loaded, dict):
            raise RegistryError(f"{config}: expected settings such as 'learning: {{j_threshold: 100}}'")
        for section, values in loaded.items():
            merge = isinstance(values, dict) and isinstance(given.get(section), dict)
            given[section] = {**given[section], **values} if merge else values
    for section, name, value in (
        ("labels", "votes", votes),
        ("flow", "concurrent", concurrent),
        ("labels", "longest_side", longest_side),
        ("proposal", "longest_side", longest_side),
    ):
        if value is not None:
            given[section] = {**(given.get(section) or {}), name: value}
    try:
        return Settings.model_validate(given)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        source = config or "the learning section of domain.yaml"
        raise RegistryError(f"{source}: {where}: {first['msg']} (found {first['input']!r})") from error
