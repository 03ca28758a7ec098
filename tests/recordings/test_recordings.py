"""A large model's recorded answers, replayed under the published protocol: what was learned and solved with them.

A stored answer is found only for a question that is the same byte for byte, prompt and pictures included. These tests
therefore fail when a published prompt, a request or the drawing of burger pictures changes.
"""

from __future__ import annotations

import io
import lzma
import tarfile
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from extras import need
from pack_recording import pack_folder
from pix2pred.demos import Project, read_project, read_tasks, write_project
from pix2pred.execution import Solver
from pix2pred.pipeline import Learned, LearningProblem, learn
from pix2pred.predicates import Labeller
from pix2pred.recordings import Recording, load_recording, recording_names
from pix2pred.recordings.archive import unpack_folder
from pix2pred.registry import load_domain, load_planner
from pix2pred.settings import of_file, of_project, resolve
from pix2pred.structs import Image, PlanStatus
from pix2pred.structs.environment import SimulatedTask
from pix2pred.structs.formats.names import UnknownNameError
from pix2pred.vlm import Answer, AnswerStore, Request, StoredVLM, StoreMode
from pix2pred.vlm.answers.replay import replayed


@dataclass
class Replay:
    """The recorded model, and the keys of the questions it was asked."""

    store: AnswerStore
    keys: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._model = StoredVLM(replayed(self.store), self.store, StoreMode.REPLAY)
        self.name = self._model.name

    def answer(self, request: Request) -> Answer:
        self.keys.add(request.key(self.name))
        return self._model.answer(request)


@dataclass(frozen=True)
class Replayed:
    recording: Recording
    project: Project
    model: Replay
    learned: Learned
    solver: Solver
    tasks: tuple[SimulatedTask, ...]


@pytest.fixture(scope="module")
def replay(tmp_path_factory: pytest.TempPathFactory):  # type: ignore[no-untyped-def]
    @cache
    def run(name: str) -> Replayed:
        folder = tmp_path_factory.mktemp(name)
        recording = load_recording(name)
        recording.unpack_answers(folder / "answers")
        project = _project(recording, folder / "data")
        settings = resolve(of_project(project.sections), *([of_file(recording.settings)] if recording.settings else []))
        model = Replay(AnswerStore(folder / "answers"))
        learned = learn(LearningProblem(project.vocabulary, project.demos, model, settings))
        solver = Solver(
            learned.model, load_planner("portfolio"), Labeller(model, settings.labels), samplers=learned.samplers
        )
        tasks = read_tasks(folder / "data", project.vocabulary)
        stored = tuple(SimulatedTask(t.task, t.simulator or {}) for t in tasks)
        return Replayed(recording, project, model, learned, solver, stored)

    return run


def _project(recording: Recording, folder: Path) -> Project:
    about = recording.about
    if recording.brings_data:
        recording.unpack_data(folder)
    else:
        domain = load_domain(about.domain)
        family = about.family
        unseen = domain.tasks(family, about.seed, about.tasks)
        drawn = domain.demonstrations(family, about.seed)
        simulator = {"domain": about.domain, "family": family}
        write_project(folder, domain.vocabulary(family), drawn, unseen, simulator, domain.settings(family))
    return read_project(folder)


LEARNED = {
    "combo": (["chopped0", "gripper_empty0", "cooked0"], 17, [313_911, 10_356, 3_598, 373]),
    "kitchen": (["burner_glowing0"], 2, [3_097, 33]),
    "coffee": (["machine_loaded0", "jug_contains_coffee0", "jug_empty0"], 10, [6_411, 5_457, 109, 87]),
}
"""Predicates in the order they were chosen, number of operators, and J before and after each choice."""

LENGTHS = {"combo": [24] * 5 + [30] * 5, "kitchen": [2] * 10, "coffee": [8, 8, 8, 8, 7, 7, 8, 7, 8, 7]}
"""Skills in the plan of each task."""


@pytest.mark.parametrize("name", LEARNED)
def test_the_recorded_answers_give_the_recorded_model(replay, name: str) -> None:  # type: ignore[no-untyped-def]
    run = replay(name)
    selected, operators, js = LEARNED[name]
    assert [p.name for p in run.learned.model.selected] == selected
    assert len(run.learned.model.operators) == operators
    assert [round(step.j) for step in run.learned.selection.steps] == js


@pytest.mark.parametrize("name", LENGTHS)
def test_every_task_is_planned_from_its_picture_and_every_shipped_answer_is_used(replay, name: str) -> None:  # type: ignore[no-untyped-def]
    run = replay(name)
    plans = [run.solver.plan(task.task)[1] for task in run.tasks]
    assert [plan.status for plan in plans] == [PlanStatus.SOLVED] * len(plans)
    assert [len(plan.plan) for plan in plans] == LENGTHS[name]
    assert run.model.keys == set(run.model.store.all_keys())


@pytest.mark.parametrize("name", ["combo", "coffee", pytest.param("kitchen", marks=need("mujoco", extra="sim"))])
def test_the_plans_reach_their_goals_in_the_simulator(replay, name: str) -> None:  # type: ignore[no-untyped-def]
    run = replay(name)
    domain = load_domain(run.recording.about.domain)
    for task in run.tasks:
        episode = run.solver.solve(task.task, domain.environment(task.task, task.simulator))
        assert episode.solved, (episode.task, episode.failure, episode.detail)


def test_every_recording_says_what_it_proves_and_what_it_does_not() -> None:
    assert set(recording_names()) == set(LEARNED)
    for name in recording_names():
        about = load_recording(name).about
        assert about.shows and about.does_not_show
    with pytest.raises(UnknownNameError, match="combo"):
        load_recording("comb")


def test_a_folder_comes_out_of_its_archive_as_it_went_in(tmp_path: Path) -> None:
    source, archive = tmp_path / "in", tmp_path / "a.tar.xz"
    (source / "demos").mkdir(parents=True)
    picture = Image.from_pixels(np.random.default_rng(0).integers(0, 256, (20, 30, 3), dtype=np.uint8))
    (source / "demos" / "0.png").write_bytes(picture.encoded)
    (source / "domain.yaml").write_text("name: x\n")
    pack_folder(source, ["domain.yaml", "demos/0.png"], archive)
    first = archive.read_bytes()
    pack_folder(source, ["demos/0.png", "domain.yaml"], archive)
    assert archive.read_bytes() == first
    unpack_folder(archive, tmp_path / "out")
    assert (tmp_path / "out/domain.yaml").read_text() == "name: x\n"
    assert Image((tmp_path / "out/demos/0.png").read_bytes()).digest == picture.digest


def test_an_archive_writes_nothing_outside_its_folder(tmp_path: Path) -> None:
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w") as tar:
        tar.addfile(tarfile.TarInfo("../outside.txt"), io.BytesIO())
    (tmp_path / "a.tar.xz").write_bytes(lzma.compress(packed.getvalue()))
    with pytest.raises(ValueError, match="outside"):
        unpack_folder(tmp_path / "a.tar.xz", tmp_path / "in")
    assert not (tmp_path / "outside.txt").exists()
