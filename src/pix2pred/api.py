"""The whole job in a few calls, for notebooks and scripts: read, learn, look at the operators, plan.

Thin over the library, as the command line is; whoever needs more calls ``pipeline``, ``execution`` and ``runs``.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from pydantic import ValidationError

from pix2pred.demos import Project, StoredTask, read_project, read_task
from pix2pred.execution import PlannedScene, Solver, plan_scene
from pix2pred.execution.belief.perception import Believing
from pix2pred.learning.samplers.file import load_samplers
from pix2pred.pipeline import Learned, LearningProblem
from pix2pred.pipeline import learn as learn_world
from pix2pred.planning.pddl.write import write_domain, write_problem
from pix2pred.predicates import labeller_for
from pix2pred.registry import REGISTRY, Registry, check_family
from pix2pred.report import REPORT, load_contents, render, write_report
from pix2pred.report.cards import model_cards
from pix2pred.report.plan_page import render_plan
from pix2pred.runs import addresses
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.runs.layout import CONFIG, MODEL, SAMPLERS
from pix2pred.runs.learn import save_learned
from pix2pred.runs.metrics import climbed
from pix2pred.runs.verdict import concerns
from pix2pred.settings import Settings, of_kind, of_project, resolve
from pix2pred.structs import Operator, Predicate, Task, WorldModel
from pix2pred.structs.environment import asking_settings
from pix2pred.structs.formats import world_model as files
from pix2pred.system.extras import optional
from pix2pred.system.progress import Progress, silent
from pix2pred.vlm import VLM, AnswerStore, Together


@dataclass(frozen=True, repr=False)
class Model:
    """A learned world model together with the vision-language model that labels new scenes for it.

    ``learned`` holds proposals, labels and the course of selection; it is None for a model read from a run folder,
    which ``run`` then names. ``problem`` is what it was learned from, and ``spec`` the name by which its model was
    asked for, if it had one.
    """

    solver: Solver
    learned: Learned | None = None
    problem: LearningProblem | None = None
    spec: str = ""
    run: Path | None = None

    def __repr__(self) -> str:
        selected = ", ".join(p.name for p in self.selected) or "none"
        return f"<Model of {self.world.vocabulary.name}: selected {selected}; {len(self.operators)} operators>"

    def _repr_html_(self) -> str:
        return model_cards(self.world, self.verdict)

    @property
    def verdict(self) -> tuple[str, ...]:
        """What is wrong with the model, in sentences; empty when nothing stands out."""
        if self.learned is None:
            assert self.run is not None, "what was not learned here was read from a run"
            return tuple(map(str, load_contents(RunFolder(self.run)).verdict))
        assert self.problem is not None, "what was learned here had a problem"
        table, settings = self.learned.selected.table, self.problem.settings.learning
        how = climbed(self.learned.selection, table, settings)
        return tuple(map(str, concerns(self.world, table.demos, how)))

    def save(self, folder: Path | str) -> Path:
        """Write everything into a run folder, which ``load_model`` and every command read; gives its path.

        A model that labels under no name of ``--vlm`` is kept under its own; ``load_model`` then has to be told how to
        reach it. Raises ``RunFolderError`` for a folder that holds something else.
        """
        path = Path(folder)
        if self.learned is None or self.problem is None:
            assert self.run is not None, "what was not learned here was read from a run"
            if path.exists():
                raise RunFolderError(f"{path}: is there already; a copy of {self.run} needs a place of its own")
            shutil.copytree(self.run, path)
            return path
        with RunFolder(path).locked() as run:
            save_learned(run, self.problem, self.learned, self.spec)
            write_report(run)
        return path

    def report(self) -> str:
        """The report as one HTML page, with pictures."""
        if self.run is not None:
            return render(load_contents(RunFolder(self.run)))
        with TemporaryDirectory() as folder:
            return (self.save(Path(folder) / "run") / REPORT).read_text(encoding="utf-8")

    @property
    def world(self) -> WorldModel:
        """Vocabulary, selected predicates and operators."""
        return self.solver.model

    @property
    def selected(self) -> tuple[Predicate, ...]:
        """The predicates that were invented and kept."""
        return self.world.selected

    @property
    def operators(self) -> tuple[Operator, ...]:
        """The learned operators; printing one shows its preconditions and effects."""
        return self.world.operators

    @property
    def pddl(self) -> str:
        """The PDDL domain."""
        return write_domain(self.world)

    def to_unified_planning(self, scene: PlannedScene | None = None) -> Any:
        """The model as a ``Problem`` of unified-planning, with objects, facts and goal of ``scene`` if one is given.

        Raises ``MissingExtraError`` without the extra ``planners``.
        """
        reader = optional("unified_planning.io", "planners").PDDLReader()
        if scene is None:
            return reader.parse_problem_string(self.pddl)
        task = scene.task
        problem = write_problem(self.world, task.name, task.objects, scene.seen, task.goal)
        return reader.parse_problem_string(self.pddl, problem)

    def plan(self, task: Path | str | Task | StoredTask) -> PlannedScene:
        """Label the photos of a task, given as such or by its folder, and plan.

        ``result.status`` of what is returned says whether there is a plan, ``actions`` lists it, ``rests_on`` the
        atoms of the photos it needs; ``missing`` and ``unlabelled`` say why there is none. Raises ``FolderError`` for
        a folder that cannot be read, and ``VLMError`` when the model cannot be asked.
        """
        if isinstance(task, str | Path):
            task = read_task(Path(task), self.world.vocabulary)
        return plan_scene(self.solver, task.task if isinstance(task, StoredTask) else task)

    @staticmethod
    def explain(scene: PlannedScene) -> str:
        """One HTML page that says which labels a plan rests on."""
        return render_plan(scene)


def read_data(folder: Path | str) -> Project:
    """The vocabulary and demonstrations of a project folder. Raises ``FolderError`` with every problem in it."""
    return read_project(Path(folder))


def generate(domain: str, family: str | None = None, seed: int = 0, demos: Sequence[int] | None = None) -> Project:
    """Demonstrations drawn by a simulated domain, all or those with the numbers ``demos``.

    Raises ``UnknownNameError`` for a domain or family that does not exist.
    """
    made = REGISTRY.domain(domain)
    chosen = family or made.families[0]
    check_family(made, chosen)
    drawn = made.demonstrations(chosen, seed)
    kept = drawn if demos is None else [drawn[i] for i in demos]
    simulator = {"domain": domain, "family": chosen}
    return Project(
        made.vocabulary(chosen), tuple(kept), made.settings(chosen), simulator, asking_settings(made, chosen)
    )


def learn(
    data: Project | Path | str,
    vlm: str | VLM = "offline",
    *,
    answers: Path | str | None = None,
    settings: Settings | None = None,
    planner: str = "portfolio",
    progress: Progress = silent,
) -> Model:
    """Learn a world model from a project, or from the folder of one.

    ``vlm`` is a name as for ``pix2pred learn --vlm``, or any object that answers requests. ``answers`` is a folder that
    keeps every answer, so that nothing is asked twice; without one, answers are forgotten. ``settings`` are by default
    those of the project. Raises what ``pipeline.learn`` raises, and ``UnknownNameError`` or ``ModelNameError`` for a
    name nobody knows.
    """
    project = data if isinstance(data, Project) else read_data(data)
    chosen = settings or resolve(of_kind(project.simulator), of_project(project.sections))
    model = _vlm(vlm, (project.simulator or {}).get("domain"), Path(answers) if answers else None, chosen)
    problem = LearningProblem(project.vocabulary, project.demos, model, chosen, progress)
    learned = learn_world(problem)
    labeller = labeller_for(model, chosen.labels, Together(chosen.flow.concurrent))
    solver = Solver(learned.model, REGISTRY.planner(planner), labeller, samplers=learned.samplers)
    return Model(solver, learned, problem, vlm if isinstance(vlm, str) else "")


def load_model(run: Path | str, vlm: str | None = None, planner: str = "portfolio") -> Model:
    """The model of a run folder; ``vlm`` looks at new scenes in place of the model that labelled the run.

    Raises ``RunFolderError`` for a folder without a finished run.
    """
    solver, _ = load_solver(RunFolder(Path(run)), planner, vlm=vlm)
    return Model(solver, run=Path(run))


def load_solver(
    folder: RunFolder,
    planner: str,
    *,
    closed_loop: bool = False,
    ask_again: int | None = None,
    vlm: str | None = None,
    registry: Registry = REGISTRY,
) -> tuple[Solver, dict[str, Any]]:
    """A solver with the model, labeller and answer store of a run, and the run's configuration.

    ``ask_again`` is the number of atoms that may be asked about again in one look; by default what a closed loop does,
    and none in an open one, which then takes labels at their word.

    ``vlm`` looks at new scenes in place of the model that labelled the demonstrations: another model, or another way
    to reach the same one, such as ``replay:DIR``. Raises ``RunFolderError``.
    """
    config = folder.config()
    if not (folder.path / MODEL).exists():
        raise RunFolderError(
            f"{folder.path / MODEL}: there is no world model yet; finish learning with 'pix2pred learn' first"
        )
    model = files.load_model(folder.path / MODEL)
    try:
        settings = Settings.model_validate(config["settings"])
        answers = AnswerStore(Path(config["answers"]) if config["answers"] else folder.path)
        spec = vlm or addresses.reached(config["vlm"], folder.path)
        stored = registry.stored(spec, config["simulator"].get("domain"), answers, flow=settings.flow)
        labelled_by = str(config["model"])
    except (KeyError, TypeError, AttributeError, ValidationError) as error:
        raise RunFolderError(f"{folder.path / CONFIG}: is damaged ({type(error).__name__}: {error})") from error
    if vlm is None and stored.name != labelled_by:
        raise RunFolderError(f"{folder.path}: was labelled by {labelled_by}, but {spec!r} is {stored.name}")
    labeller = labeller_for(stored, settings.labels, Together(settings.flow.concurrent))
    samplers = load_samplers(folder.path / SAMPLERS) if (folder.path / SAMPLERS).exists() else {}
    perceiving = None if ask_again is None else Believing(ask_again)
    made = Solver(model, registry.planner(planner), labeller, closed_loop, samplers=samplers, perceiving=perceiving)
    return made, config


def _vlm(vlm: str | VLM, domain: str | None, answers: Path | None, settings: Settings) -> VLM:
    if not isinstance(vlm, str):
        return vlm
    if answers is None and REGISTRY.model_spec(vlm).own_answers is None:
        return REGISTRY.vlm(vlm, domain, settings.flow)
    store = AnswerStore(answers or Path())  # a replay brings its own instead
    return REGISTRY.stored(vlm, domain, store, flow=settings.flow)
