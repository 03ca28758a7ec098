"""A learned world model as tools that other programs call over the Model Context Protocol.

The tools say what the model knows, what it sees in photos, what it would do, and what a plan does step by step. They
execute nothing and write nothing but, where a model may be asked, its answers into the run.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import Any

from pix2pred import __version__
from pix2pred.execution import PlannedScene, Solver, plan_scene
from pix2pred.planning.alternatives import plan_for_any
from pix2pred.planning.pddl.check import check_plan
from pix2pred.planning.pddl.read import read_domain, read_problem
from pix2pred.planning.pddl.steps import read_plan
from pix2pred.planning.pddl.write import write_domain, write_plan, write_problem
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.photo_task import PhotoTaskError, SceneInWords, atom_in_words, names_of, object_in_words, photo_task
from pix2pred.runs.plan_folder import plan_document
from pix2pred.structs import AbstractState, Atom, Object, PlanStatus, Predicate
from pix2pred.structs.goals.words import parse_goals
from pix2pred.system.errors import Pix2predError
from pix2pred.system.extras import optional

INSTRUCTIONS = (
    "Tools of a symbolic world model that was learned from pictures. Atoms are written On(cup, table), objects "
    "name:type. Call world_model first: it lists types, predicates with their meaning, and actions. A plan is a "
    "proposal; nothing here executes anything."
)


Tool = Callable[..., dict[str, Any]]
"""What it gives is a JSON document."""


@dataclass(frozen=True, slots=True)
class Tools:
    """What programs may call. ``photos`` is the folder whose pictures may be looked at; others are not opened."""

    run: RunFolder
    solver: Solver
    photos: Path

    def world_model(self) -> dict[str, Any]:
        """The types, objects, skills and predicates (with meaning) of the domain, and its actions as PDDL."""
        model = self.solver.model
        return {
            "name": model.vocabulary.name,
            "types": {t.name: t.parent.name if t.parent else None for t in model.vocabulary.types},
            "skills": [f"{s.name}({', '.join(t.name for t in s.types)})" for s in model.vocabulary.skills],
            "predicates": [_predicate(p) for p in model.predicates],
            "labelled_by": model.labels_from,
            "pddl": write_domain(model),
        }

    def describe(
        self, photos: list[str], objects: list[str] | None = None, holds: list[str] | None = None
    ) -> dict[str, Any]:
        """What the photos show: the atoms that hold, each visual one with the probability that is believed.

        ``photos`` are paths below the folder of photos, one per camera. ``objects`` are the things in the scene, as
        ``name`` or ``name:type`` for a new one; by default all of the demonstrations. ``holds`` are atoms that no
        photo shows, such as what a gripper holds.
        """
        scene = self._seen(SceneInWords((), objects or (), holds or ()), photos)
        return {
            "holds": [str(a) for a in sorted(scene.seen)],
            "believed": {str(a): round(p, 4) for a, p in sorted(scene.believed.items())},
            "unlabelled": [str(a) for a in scene.unlabelled],
        }

    def plan_from_photos(
        self, photos: list[str], goal: list[str], objects: list[str] | None = None, holds: list[str] | None = None
    ) -> dict[str, Any]:
        """A plan for the goal atoms from what the photos show, what it rests on, or what is missing for one.

        ``photos``, ``objects`` and ``holds`` are as for ``describe``; ``goal`` lists what is to hold:
        atoms, or ``not``, ``and`` and ``or`` of atoms.
        """
        if not goal:
            raise PhotoTaskError("goal: name at least one atom that is to hold, such as 'On(cup, table)'")
        scene = self._seen(SceneInWords(goal, objects or (), holds or ()), photos)
        return plan_document(scene) | {"lines": self._lines(scene.task.objects, scene)}

    def plan_from_atoms(self, objects: list[str], holds: list[str], goal: list[str]) -> dict[str, Any]:
        """A plan from a state that is given in atoms; no picture is looked at and no model asked.

        ``objects`` are written ``name:type``; every atom that ``holds`` does not list is false.
        """
        things, state, goals = self._in_words(objects, holds, goal)
        model = self.solver.model
        result = plan_for_any(self.solver.planner, model.operators, things, state, goals)
        lines = write_plan(model, things, result.plan).splitlines() if result.status == PlanStatus.SOLVED else []
        return {"status": result.status.value, "plan": [str(step) for step in result.plan], "lines": lines}

    def validate(self, objects: list[str], holds: list[str], goal: list[str], lines: list[str]) -> dict[str, Any]:
        """What each step of a plan makes true and false, what is missing where it fails, and whether the goal holds.

        ``objects`` and ``holds`` are as for ``plan_from_atoms``; ``lines`` are steps as ``(action object ...)``.
        """
        things, state, goals = self._in_words(objects, holds, goal)
        model = self.solver.model
        domain = read_domain(write_domain(model))
        problem = read_problem(write_problem(model, "asked", things, state, *goals), domain)
        return check_plan(domain, problem, read_plan("\n".join(lines), domain, problem)).as_dict()

    def all(self) -> tuple[Tool, ...]:
        """The tools, in the order in which they are listed."""
        return self.world_model, self.describe, self.plan_from_photos, self.plan_from_atoms, self.validate

    def _seen(self, said: SceneInWords, photos: Sequence[str]) -> PlannedScene:
        paths = [self._photo(name) for name in photos]
        return plan_scene(self.solver, photo_task(self.run, self.solver.model, paths, said))

    def _photo(self, name: str) -> Path:
        folder = self.photos.resolve()
        path = (folder / name).resolve()
        if not path.is_relative_to(folder) or not path.is_file():
            raise PhotoTaskError(f"{name}: there is no such photo in the folder of photos, which --photos names")
        return path

    def _lines(self, objects: Sequence[Object], scene: PlannedScene) -> list[str]:
        return write_plan(self.solver.model, objects, scene.result.plan).splitlines() if scene.solved else []

    def _in_words(
        self, objects: Sequence[str], holds: Sequence[str], goal: Sequence[str]
    ) -> tuple[tuple[Object, ...], AbstractState, tuple[tuple[Atom, ...], ...]]:
        names = names_of(self.solver.model)
        try:
            things = {o.name: o for o in (object_in_words(text, names) for text in objects)}
            state = frozenset(atom_in_words(text, names, things) for text in holds)
            goals = parse_goals(goal, lambda written: names.atom(written.name, written.args, things)) or ((),)
        except ValueError as error:
            raise PhotoTaskError(str(error)) from error
        return tuple(sorted(things.values())), state, goals


def _predicate(predicate: Predicate) -> dict[str, Any]:
    return {
        "predicate": f"{predicate.name}({', '.join(t.name for t in predicate.types)})",
        "meaning": predicate.description,
    }


def server_of(tools: Tools) -> Any:
    """A Model Context Protocol server with these tools. Raises ``MissingExtraError`` without the extra ``mcp``."""
    made = optional("mcp.server", "mcp").MCPServer(
        "pix2pred", version=__version__, instructions=INSTRUCTIONS, log_level="WARNING"
    )
    hints = optional("mcp.types", "mcp").ToolAnnotations(read_only_hint=True, open_world_hint=False)
    for tool in tools.all():
        made.add_tool(_telling(tool), annotations=hints, structured_output=True)
    return made


def _telling(tool: Tool) -> Tool:
    """The tool with its errors as answers: the protocol passes on the words of its own kind of error alone."""
    refused = optional("mcp.server.mcpserver.exceptions", "mcp").ToolError

    @wraps(tool)
    def called(*given: Any, **named: Any) -> dict[str, Any]:
        try:
            return tool(*given, **named)
        except (Pix2predError, OSError) as error:
            raise refused(str(error)) from error

    return called
