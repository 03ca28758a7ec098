"""``generate``, ``check`` and ``schema``: demonstrations on disk."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from pix2pred.cli.console import bars, counted, err, out, plain, print_json
from pix2pred.cli.estimating import estimated, project_settings
from pix2pred.cli.ranges import NOT_NEGATIVE, output_folder
from pix2pred.demos import Problem, Project, inspect_project, json_schemas, write_project, write_schemas
from pix2pred.pipeline import LearningProblem, finished_before_it_began
from pix2pred.registry import MODEL_FORMS, Registry, check_family
from pix2pred.settings import SettingsError
from pix2pred.structs.environment import asking_settings
from pix2pred.system.progress import Stage
from pix2pred.vlm import AnswerStore

EXAMPLE_MODEL = "openai:gpt-4o"
"""Whose prices are shown where nobody has said which model it will be."""


def generate(
    domain: Annotated[str, Parameter(help="burger, kitchen, coffee, or a domain of another package.")],
    /,
    *,
    family: Annotated[str | None, Parameter(help="Family of demonstrations [default: the domain's first].")] = None,
    seed: Annotated[int, Parameter(help="Varies counts and positions.", validator=NOT_NEGATIVE)] = 0,
    tasks: Annotated[int, Parameter(help="Number of unseen test tasks to add.", validator=NOT_NEGATIVE)] = 10,
    out: Annotated[Path, Parameter(name="--out", help="Folder to write.", validator=output_folder)],
    overwrite: Annotated[bool, Parameter(help="Replace a project that is already there.")] = False,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
    registry: Annotated[Registry, Parameter(parse=False)],
) -> int:
    """Write demonstrations and test tasks of a simulated domain as a project folder.

    For example:

    - `pix2pred generate burger --family more-stacks --seed 0 --out data/stacks`
    """
    made = registry.domain(domain)
    family = family or made.families[0]
    check_family(made, family)
    with bars() as progress:
        progress(Stage.GENERATE, 0, 2, "demonstrations")
        demos = made.demonstrations(family, seed)
        progress(Stage.GENERATE, 1, 2, "tasks")
        unseen = made.tasks(family, seed, tasks)
        progress(Stage.GENERATE, 2, 2, "")
    write_project(
        out,
        made.vocabulary(family),
        demos,
        unseen,
        {"domain": domain, "family": family},
        made.settings(family),
        asking=asking_settings(made, family),
        overwrite=overwrite,
    )
    if json:
        print_json({"folder": str(out), "demonstrations": len(demos), "tasks": len(unseen)})
    else:
        err.print(f"{len(demos)} demonstrations and {len(unseen)} tasks in {out}", markup=False)
    return 0


def check(
    directory: Annotated[Path, Parameter(help="Project folder.")],
    /,
    *,
    vlm: Annotated[
        str | None,
        Parameter(help=f"Model to reckon the cost with [default: offline or {EXAMPLE_MODEL}]: {MODEL_FORMS}."),
    ] = None,
    cost: Annotated[
        bool, Parameter(help="Reckon what learning would ask and cost; nothing is sent.", negative="--no-cost")
    ] = True,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
    registry: Annotated[Registry, Parameter(parse=False)],
) -> int:
    """Say everything that is wrong with a project folder, what will hurt later, and what learning would cost.

    Problems name file and line, and have to be put right; warnings do not. Exit code 2 when there are problems.

    For example:

    - `pix2pred check data/stacks --vlm openai:gpt-4o`
    """
    found = inspect_project(directory)
    problems = [*found.problems, *(_settings_problems(directory, found.project) if found.project else ())]
    estimate, not_known = None, ""
    if found.project and cost and not problems:
        try:
            estimate = _estimate(registry, found.project, vlm)
        except (ValueError, ImportError) as error:  # no pictures yet, or a simulator that is not installed here
            if vlm:
                raise
            not_known = str(error)
    warnings = [*found.warnings, *(_cautions(directory, registry, found.project) if estimate and found.project else ())]
    if json:
        print_json({"problems": _rows(problems), "warnings": _rows(warnings), "learning": estimate})
        return 2 if problems else 0
    for problem in problems:
        out.print(plain(str(problem)), markup=False, soft_wrap=True)
    for warning in warnings:
        out.print(plain(warning.told("warning")), markup=False, soft_wrap=True)
    count = counted(len(problems), "problem") if problems else "no problems found"
    out.print(f"{count}, {counted(len(warnings), 'warning')}" if warnings else count)
    if estimate:
        out.print(_said(estimate), markup=False, soft_wrap=True)
    elif not_known:
        out.print(f"what learning would cost is not known: {not_known}", markup=False, soft_wrap=True)
    return 2 if problems else 0


def _settings_problems(directory: Path, project: Project) -> list[Problem]:
    """What is wrong with the project's settings for learning."""
    try:
        project_settings(project)
    except SettingsError as error:
        return [Problem(directory / "domain.yaml", None, str(error))]
    return []


def _cautions(directory: Path, registry: Registry, project: Project) -> list[Problem]:
    """What will make the learned model useless although nothing is wrong with the project."""
    nobody = registry.estimator(EXAMPLE_MODEL, None, AnswerStore(Path("no-answers")))
    problem = LearningProblem(project.vocabulary, project.demos, nobody, project_settings(project))
    j = finished_before_it_began(problem)
    if j is None:
        return []
    threshold = problem.settings.learning.j_threshold
    said = (
        f"selection would end before it began: with the given predicates alone J is {j:,.0f}, and it stops at or below "
        f"j_threshold = {threshold:,.0f}; write 'learning: {{operators: robust}}', or a smaller j_threshold"
    )
    return [Problem(directory / "domain.yaml", None, said)]


def _rows(problems: Sequence[Problem]) -> list[dict[str, str | int | None]]:
    return [{"file": str(p.file), "line": p.line, "message": p.message} for p in problems]


def _estimate(registry: Registry, project: Project, vlm: str | None) -> dict[str, Any]:
    """What learning with the project's own settings would ask, none of it stored yet."""
    domain = (project.simulator or {}).get("domain")
    spec = vlm or ("offline" if domain and registry.domain(domain).reader else EXAMPLE_MODEL)
    settings = project_settings(project)
    return {**estimated(registry, project, settings, spec, AnswerStore(Path("no-answers"))), "asked_of": spec}


def _said(estimate: Mapping[str, Any]) -> str:
    tokens = f"{estimate['input_tokens']:,} tokens in, {estimate['output_tokens']:,} out"
    cost = "" if estimate["dollars"] is None else f", about ${estimate['dollars']:.2f}"
    return (
        f"learning with {estimate['asked_of']} would ask about {estimate['queries']:,} questions with "
        f"{estimate['pictures']:,} pictures ({tokens}{cost}); by stage: pix2pred learn --dry-run"
    )


def schema(
    *,
    out: Annotated[
        Path | None,
        Parameter(name="--out", help="Folder to write them to [default: print them].", validator=output_folder),
    ] = None,
) -> int:
    """JSON Schemas of domain.yaml, demo.yaml, task.yaml and import.yaml, for editors that complete and check YAML.

    For example:

    - `pix2pred schema --out my-project/schemas`
    """
    if out is None:
        print_json(json_schemas())
    else:
        for file in write_schemas(out):
            err.print(str(file), markup=False)
    return 0
