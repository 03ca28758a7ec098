"""``plan``: from the photo of a new scene to a plan, and to its execution by a person."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.markup import escape

from pix2pred.api import load_solver
from pix2pred.cli.console import UsageError, counted, err, out, plain, print_json
from pix2pred.cli.guide import Photos, TypedPaths, WatchedFolder, guide, print_missing
from pix2pred.cli.learn import say_where_questions_wait
from pix2pred.cli.ranges import NOT_NEGATIVE, output_folder
from pix2pred.demos import read_task
from pix2pred.execution import PlannedScene, plan_scene
from pix2pred.execution.explaining.wording import in_words
from pix2pred.registry import Registry
from pix2pred.report.plan_page import render_plan
from pix2pred.runs import addresses
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.layout import PLANS
from pix2pred.runs.photo_task import SceneInWords, photo_task
from pix2pred.runs.plan_folder import PAGE, PlanFolder, plan_document
from pix2pred.runs.verdict import doubts_about
from pix2pred.structs import PlanStatus, Task, WorldModel

_NO_PLAN = {
    PlanStatus.UNSOLVABLE: "no plan: the goal cannot be reached from what was seen",
    PlanStatus.BUDGET: "no plan within the budget of the search; try --planner gbfs-ff",
    PlanStatus.NOT_FOUND: "no plan: the planner gave up without a proof that there is none",
    PlanStatus.TIMEOUT: "no plan: the planner was stopped",
}


# Longer than others: every option is a line, with its help.
def plan(
    run: Annotated[Path, Parameter(help="Run folder, as made by learn.")],
    /,
    *,
    task: Annotated[
        Path | None, Parameter(help="Folder of the task: task.yaml with objects and goal, images/0 with photos.")
    ] = None,
    photo: Annotated[
        list[Path] | None,
        Parameter(help="Photo of the scene, instead of --task; one per camera.", consume_multiple=True),
    ] = None,
    goal: Annotated[
        list[str] | None,
        Parameter(
            help="With --photo: what is to hold, such as 'On(cup, table)', or 'not', 'and', 'or' of such.",
            consume_multiple=True,
        ),
    ] = None,
    thing: Annotated[
        list[str] | None,
        Parameter(
            help="With --photo: object in the scene, NAME or NAME:TYPE for a new one [default: all known ones].",
            consume_multiple=True,
        ),
    ] = None,
    holds: Annotated[
        list[str] | None,
        Parameter(
            help="With --photo: atom that holds and that no photo shows, such as 'Held(cup)'.", consume_multiple=True
        ),
    ] = None,
    out_dir: Annotated[
        Path | None,
        Parameter(
            name="--out",
            help="Folder to write [default: RUN/plans/TASK, or TASK-2 next to another plan].",
            validator=output_folder,
        ),
    ] = None,
    vlm: Annotated[
        str | None, Parameter(help="What looks at the photos [default: the model that labelled the run].")
    ] = None,
    planner: Annotated[
        str, Parameter(help="portfolio, astar-lmcut, gbfs-ff, or an engine of the extra 'planners'.")
    ] = "portfolio",
    ask_again: Annotated[
        int | None,
        Parameter(
            help="Atoms that may be asked about again in one look, when in doubt [default: 4].", validator=NOT_NEGATIVE
        ),
    ] = None,
    interactive: Annotated[bool, Parameter(help="Execute the plan with me: name each skill, look at a photo.")] = False,
    photos: Annotated[Path | None, Parameter(help="Take the photos from this folder as they appear there.")] = None,
    retake: Annotated[bool, Parameter(help="Forget the last photo of an interrupted execution.")] = False,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
    registry: Annotated[Registry, Parameter(parse=False)],
) -> int:
    """Label the photos of a new scene, plan, and write plan, PDDL, and a page that explains what the plan rests on.

    With --interactive the plan is executed by you: each skill is named, the photo you take after it is labelled,
    compared with what was expected, and the plan made anew when it has to be. Ctrl-C stops; the same command goes on.

    Exit codes: 0 there is a plan (interactive: the goal holds), 1 there is none, 2 bad input.

    For example:

    - `pix2pred plan runs/tea --photo table.jpg --goal 'In(ice, glass)'`
    - `pix2pred plan runs/tea --task data/tasks/monday`
    - `pix2pred plan runs/tea --task data/tasks/monday --interactive --photos ~/Pictures/tea`
    """
    RunFolder(run).config()
    solver, config = load_solver(RunFolder(run), planner, ask_again=ask_again, vlm=vlm, registry=registry)
    said = SceneInWords(goal or (), thing or (), holds or ())
    chosen = _task(RunFolder(run), solver.model, task, photo or (), said)
    say_where_questions_wait(registry.model_spec(vlm or addresses.reached(config["vlm"], run)))
    with PlanFolder.locked(out_dir or PlanFolder.free(run / PLANS, chosen, solver.model)) as folder:
        if folder.replaces(chosen, solver.model):
            err.print(plain(f"{folder.path}: the plan of another task there is replaced"), markup=False, soft_wrap=True)
        session = folder.session(chosen, solver.model, solver.labeller.vlm.name, retake=retake)
        scene = plan_scene(solver, chosen)
        if not json:
            _print_plan(scene)
        guided = None
        if scene.solved and (interactive or photos or session.executed):
            source: Photos | None = WatchedFolder(photos, session) if photos else TypedPaths() if interactive else None
            guided = guide(folder, session, scene, source)
        else:
            folder.write_plan(scene)
            folder.folder.write(PAGE, render_plan(scene))
        if json:
            print_json({"folder": str(folder.path)} | plan_document(scene, guided))
        else:
            out.print(f"written to {folder.path}, to look at: {folder.path / PAGE}", markup=False, soft_wrap=True)
    return 0 if (guided.reached if guided and (interactive or photos) else scene.solved) else 1


def _task(run: RunFolder, model: WorldModel, folder: Path | None, photos: Sequence[Path], said: SceneInWords) -> Task:
    """The task in a folder, or the one that a photo and a goal make."""
    in_words = bool(photos or said.goal or said.objects or said.given)
    if (folder is None) != in_words:
        raise UsageError("name the scene: --task FOLDER, or --photo PHOTO --goal ATOM")
    if folder is not None:
        return read_task(folder, model.vocabulary).task
    if not photos:
        raise UsageError("--goal goes with --photo: give the photo of the scene")
    if not said.goal:
        raise UsageError("--goal: say what is to hold, such as --goal 'On(cup, table)'")
    return photo_task(run, model, photos, said)


def _print_plan(scene: PlannedScene) -> None:
    name = plain(scene.task.name)
    if scene.solved:
        steps = len(scene.result.plan)
        out.print(
            f"{name}: a plan of {counted(steps, 'skill')}" if steps else f"{name}: the goal holds already", markup=False
        )
        for number, step in enumerate(scene.result.plan, start=1):
            out.print(f"{number:>3}  {plain(in_words(step))}", markup=False, soft_wrap=True)
        out.print(f"It rests on {counted(len(scene.rests_on), 'atom')} of the first look.", markup=False)
        for doubt in doubts_about(scene.result.plan):
            out.print(f"     [yellow]doubt:[/yellow] {escape(plain(doubt))}", soft_wrap=True)
    else:
        out.print(f"{name}: {_NO_PLAN[scene.result.status]}", markup=False)
        print_missing(scene.missing)
        if scene.result.status == PlanStatus.UNSOLVABLE and not scene.missing:
            out.print("     Every goal atom can be reached for itself, but not all of them together.")
    if scene.unlabelled:
        atoms = ", ".join(str(a) for a in scene.unlabelled[:5])
        more = f" and {len(scene.unlabelled) - 5} more" if len(scene.unlabelled) > 5 else ""
        out.print(plain(f"     No label, taken for false: {atoms}{more}"), markup=False, soft_wrap=True)
    if scene.would_help:
        atoms = ", ".join(str(a) for a in scene.would_help)
        out.print(plain(f"     There would be a plan if these hold: {atoms}"), markup=False, soft_wrap=True)
