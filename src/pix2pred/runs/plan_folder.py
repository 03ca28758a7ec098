"""The folder of a plan for one photographed scene, and of its execution by a person.

    plan.txt                    one (action object ...) a line, as planning competitions write plans
    domain.pddl, problem.pddl   what any PDDL planner needs to plan again
    plan.json                   the outcome, what each step needs, what the plan rests on, or what is missing
    plan.html                   all of it to look at
    session.json, images/<t>/   the steps a person executed, and the photos after them

A session that was stopped goes on from ``session.json``: the photos are labelled again from the answer store, without
asking anybody. Every file appears complete or not at all.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from pix2pred.demos import Photographed, Project, project_digest, state_from_doc, write_state
from pix2pred.execution import Guided, Missing, PlannedScene, SeenStep
from pix2pred.planning import is_valid
from pix2pred.planning.pddl.write import write_domain, write_plan, write_problem
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.runs.verdict import doubts_about
from pix2pred.structs import Atom, Demo, GroundOperator, Task, WorldModel
from pix2pred.structs.formats.world_model import dump_model
from pix2pred.structs.goals.opposites import is_denial
from pix2pred.structs.goals.words import shown
from pix2pred.structs.plans import signed
from pix2pred.structs.predicates import source_name

SESSION, PAGE = "session.json", "plan.html"


class _Doc(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ExecutedDoc(_Doc):
    """A step that somebody executed: which one, which file showed what came of it, and the state read from it."""

    step: str
    photo: str
    told: bool
    state: dict[str, Any]


class SessionDoc(_Doc):
    """``session.json``."""

    format: Literal["pix2pred-session"] = "pix2pred-session"
    version: Literal[1] = 1
    of: str
    executed: tuple[ExecutedDoc, ...] = ()


@dataclass(slots=True)
class PlanFolder:
    """The folder of one task's plan."""

    folder: RunFolder

    @classmethod
    @contextmanager
    def locked(cls, path: Path) -> Iterator[PlanFolder]:
        """Hold the folder for this process. Raises ``RunFolderError`` when it is in use, or holds other things."""
        if (
            path.is_dir()
            and any(path.iterdir())
            and not (path / "plan.json").exists()
            and not (path / ".lock").exists()
        ):
            raise RunFolderError(f"{path}: holds other files and no plan; choose another folder with --out")
        with RunFolder(path).locked() as folder:
            yield cls(folder)

    @staticmethod
    def free(plans: Path, task: Task, model: WorldModel) -> Path:
        """The first of ``NAME``, ``NAME-2``, ... in ``plans`` that holds no plan yet, or that of this very task.

        So a second goal for a photo, or a photo of the same name, takes no plan's place. A folder in which a person
        began to execute a plan counts as this task's: ``session`` says when it is not.
        """
        paths = (plans / (task.name if number == 1 else f"{task.name}-{number}") for number in count(1))
        return next(p for p in paths if (p / SESSION).exists() or _same_task(p, task, model) in (None, True))

    def replaces(self, task: Task, model: WorldModel) -> bool:
        """Whether the plan of another task stands here, which this one is going to replace."""
        return _same_task(self.path, task, model) is False

    @property
    def path(self) -> Path:
        """Where it is."""
        return self.folder.path

    def write_plan(self, scene: PlannedScene, guided: Guided | None = None) -> None:
        """Write plan, PDDL and their explanation; of ``guided`` also what was executed."""
        model, task = scene.solver.model, scene.task
        plan = scene.result.plan
        assert not scene.solved or is_valid(plan, scene.seen, task.goal), "the planner's plan does not work"
        self.folder.write("domain.pddl", write_domain(model))
        self.folder.write("problem.pddl", write_problem(model, task.name, task.objects, scene.seen, task.goal))
        if scene.solved:
            self.folder.write("plan.txt", write_plan(model, task.objects, plan))
        else:
            (self.path / "plan.txt").unlink(missing_ok=True)
        self.folder.write_json("plan.json", plan_document(scene, guided))

    def session(self, task: Task, model: WorldModel, labels_from: str, *, retake: bool = False) -> SessionDoc:
        """What was executed so far; ``retake`` forgets the last step.

        Raises ``RunFolderError`` when the folder holds the session of another task, model or labeller.
        """
        of = _identity(task, model, labels_from)
        path = self.path / SESSION
        if not path.exists():
            return SessionDoc(of=of)
        try:
            session = SessionDoc.model_validate_json(path.read_bytes())
        except (ValidationError, OSError) as error:
            raise RunFolderError(f"{path}: is damaged; delete it to execute the plan anew") from error
        if session.of != of:
            raise RunFolderError(
                f"{path}: belongs to another task or world model than now; choose another --out, or delete {self.path}"
            )
        if retake:
            session = session.model_copy(update={"executed": session.executed[:-1]})
            self._save(session)
        return session

    def remember(self, session: SessionDoc, guided: Guided, photo: Path, seen: Photographed) -> SessionDoc:
        """Keep the photo of the step that was just tried, before anything is made of it; gives the longer session."""
        assert guided.step is not None, "a photo is of a step"
        number = len(session.executed) + 1
        images = self.path / "images" / str(number)
        shutil.rmtree(images, ignore_errors=True)
        doc = write_state(images, seen.state, guided.scene.task.objects)
        entry = ExecutedDoc(step=str(guided.step), photo=photo.name, told=seen.told, state=doc)
        session = session.model_copy(update={"executed": (*session.executed, entry)})
        self._save(session)
        return session

    def replay(self, session: SessionDoc, guided: Guided) -> Iterator[SeenStep]:
        """Take ``guided`` to where the session stopped. Raises ``RunFolderError`` if the steps differ."""
        for number, entry in enumerate(session.executed, start=1):
            if guided.step is None or str(guided.step) != entry.step:
                raise RunFolderError(
                    f"{self.path / SESSION}: step {number} was {entry.step}, but the plan now wants "
                    f"{guided.step or 'nothing more'}; delete {self.path} to start anew"
                )
            task = guided.scene.task
            images = self.path / "images" / str(number)
            state = state_from_doc(entry.state, images, task, guided.scene.solver.model.vocabulary)
            yield guided.observe(state, told=entry.told)

    def _save(self, session: SessionDoc) -> None:
        self.folder.write(SESSION, session.model_dump_json(indent=1) + "\n")


def _identity(task: Task, model: WorldModel, labels_from: str) -> str:
    """SHA-256 over everything a session depends on."""
    seen, *several = _scene(task, model)
    return hashlib.sha256(json.dumps([seen, dump_model(model), labels_from, *several]).encode()).hexdigest()


def _scene(task: Task, model: WorldModel) -> list[Any]:
    """What tells a task from others: a digest of picture, objects and goal, and the goal in words if it has several."""
    scene = Demo(task.name, task.objects, (task.initial,), (), task.goal)
    several = [shown(task.goals)] if task.alternatives else []
    return [project_digest(Project(model.vocabulary, (scene,), {}, None)), *several]


def _same_task(path: Path, task: Task, model: WorldModel) -> bool | None:
    """Whether the plan in a folder is of ``task``; ``None`` without a plan there, or one that cannot be read."""
    try:
        there = json.loads((path / "plan.json").read_bytes())
        return bool(there.get("of", _scene(task, model)) == _scene(task, model) and there["goal"] == _goal(task))
    except (OSError, ValueError, KeyError, AttributeError):
        return None


def _goal(task: Task) -> list[str]:
    return [str(a) for a in task.goal]


def plan_document(scene: PlannedScene, guided: Guided | None = None) -> dict[str, Any]:
    """What ``plan.json`` holds."""
    steps = [
        _step_doc(step) | {"needs": [{"atom": str(n.atom), "from": _origin(n.by)} for n in needs]}
        for step, needs in zip(scene.result.plan, scene.needs, strict=False)
    ]
    document = {
        "format": "pix2pred-plan",
        "version": 1,
        "task": scene.task.name,
        "of": _scene(scene.task, scene.solver.model),
        "goal": _goal(scene.task),
        "status": scene.result.status.value,
        "plan": steps,
        "rests_on": [_label_doc(scene, atom) for atom in scene.rests_on],
        "unlabelled": [str(a) for a in scene.unlabelled],
        "missing": [_missing_doc(m) for m in scene.missing],
        "doubts": list(doubts_about(scene.result.plan)),
        "would_help": [str(a) for a in scene.would_help],
        "nodes": scene.result.nodes,
        "labelled_by": scene.solver.labeller.vlm.name,
    }
    if guided is not None:
        document["executed"] = [_look_doc(look) for look in guided.looks]
        document["remaining"] = [_step_doc(step) for step in guided.remaining]
        document["goal_holds"] = guided.reached
        document["ended"] = guided.ended
    return document


def _origin(by: int | None) -> str:
    return "the first look" if by is None else f"step {by + 1}"


def _step_doc(step: GroundOperator) -> dict[str, Any]:
    return {
        "action": f"{step.operator.skill.name}({', '.join(o.name for o in step.skill_objects)})",
        "operator": str(step),
        "add": [str(a) for a in sorted(step.add) if not is_denial(a)],
        "delete": [str(a) for a in sorted(step.delete) if not is_denial(a)],
    }


def _label_doc(scene: PlannedScene, atom: Atom) -> dict[str, Any]:
    doc: dict[str, Any] = {"atom": str(atom), "source": source_name(atom.predicate.source)}
    if atom in scene.labels.confidence:
        doc["confidence"] = round(scene.labels.confidence[atom], 4)
    if atom in scene.believed:
        doc["believed"] = round(scene.believed[atom], 4)
    return doc | ({"said": scene.said[atom]} if atom in scene.said else {})


def _missing_doc(m: Missing) -> Mapping[str, Any]:
    return {"atom": str(m.atom), "step": str(m.step) if m.step else None, "lacks": [str(a) for a in m.lacks]}


def _look_doc(look: SeenStep) -> dict[str, Any]:
    return {
        "action": str(look.action),
        "operator": str(look.step),
        "expected": list(signed(look.expected)),
        "not_seen": list(signed(look.absent)),
        "not_expected": list(signed(look.surplus)),
        "assumed": list(signed(look.assumed)),
        "planned_again": look.replanned,
    }
