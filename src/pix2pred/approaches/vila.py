"""ViLa: the model plans directly from pictures, with or without demonstrations in the prompt (Hu et al., 2023)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, count
from typing import Any

from pix2pred.approaches.approach import Training
from pix2pred.approaches.parse_plan import NoPlanError, WrittenPlan, parse_plan
from pix2pred.execution import TruthOf
from pix2pred.predicates.labelling.settings import LabelProtocol
from pix2pred.predicates.prompt import fill, meaning_lines, titled, type_meanings, views
from pix2pred.structs import Action, Atom, Demo, Episode, ExecutedStep, Failure, Skill, Task, Type
from pix2pred.structs.environment import Environment, StepStatus
from pix2pred.structs.views import View
from pix2pred.vlm import Purpose, Request
from pix2pred.vlm.request import Part

ROOM = "pix2pred.approaches"
ANSWER_TOKENS = 4096


@dataclass(frozen=True, slots=True)
class ViLa:
    """Implements ``Approach``; nothing is learned. ``shows_demos``: demonstrations go into the prompt (few-shot)."""

    name: str
    shows_demos: bool
    needs_model: bool = True

    def train(self, training: Training) -> ViLaAgent:
        shown = tuple(training.problem.demos)[: training.shown_demos] if self.shows_demos else ()
        return ViLaAgent(training, shown)


@dataclass(frozen=True, slots=True)
class ViLaAgent:
    """Asks for a plan once and executes it open loop."""

    training: Training
    shown: tuple[Demo, ...]

    plans_with: None = None

    @property
    def summary(self) -> Mapping[str, Any]:
        return {"shown_demos": len(self.shown)}

    def solve(self, task: Task, environment: Environment, truth: TruthOf | None) -> Episode:
        vocabulary = self.training.problem.vocabulary
        answer = self.training.problem.vlm.answer(self.request(task)).text
        try:
            plan = parse_plan(answer, vocabulary.skills, vocabulary.types, task.objects)
        except NoPlanError as error:
            return _episode(task, Failure.NO_PLAN, str(error), WrittenPlan((), ()), ())
        environment.reset()
        steps: list[ExecutedStep] = []
        for action in plan.actions:
            if environment.goal_reached():
                break
            step = environment.execute(action)
            steps.append(ExecutedStep(str(action), "", step.status, step.detail))
            if environment.goal_reached():
                break
            if step.status != StepStatus.DONE:
                failure = Failure.HORIZON if step.status == StepStatus.HORIZON else Failure.SKILL
                return _episode(task, failure, step.detail, plan, steps)
        if environment.goal_reached():
            return _episode(task, None, "", plan, steps)
        why = plan.stopped or "; ".join(plan.dropped) or "the plan was executed but the goal does not hold"
        return _episode(task, Failure.NO_PLAN if not plan.actions else Failure.UNDETERMINED, why, plan, steps)

    def request(self, task: Task) -> Request:
        """The one query about a task."""
        proposal = self.training.problem.settings.proposal
        marks, size = proposal.marks, proposal.longest_side
        numbers = count()
        vocabulary = self.training.problem.vocabulary
        explained = self.training.problem.settings.labels.protocol is LabelProtocol.FRUGAL
        text = fill(
            "vila_pure",
            ROOM,
            skills="\n".join(skill_line(s, explained=explained) for s in vocabulary.skills),
            types=type_lines(vocabulary.types) + (f"\n{type_meanings(vocabulary.types)}".rstrip() if explained else ""),
            objects="\n".join(f"{o.prompt_name}: {o.type.name}" for o in sorted(task.objects)),
            goal=goal_lines(task.goals) + (_meanings(chain(*task.goals)) if explained else ""),
            examples="\nBelow are demonstrations of the same robot on other tasks.\n" if self.shown else "",
        )
        parts: list[Part] = [text]
        for d, demo in enumerate(self.shown, start=1):
            parts.append(example_text(d, demo))
            for t, state in enumerate(demo.states):
                shown = views(state, t, demo.objects, marks=marks, longest_side=size)
                parts += _numbered(shown, f"Demonstration {d}, State {t}, ", numbers)
        shown = views(task.initial, 0, task.objects, marks=marks, longest_side=size)
        parts += _numbered(shown, "Initial state to plan from, ", numbers)
        return Request(Purpose.PLAN, tuple(parts), ANSWER_TOKENS)


def _meanings(goal: Iterable[Atom]) -> str:
    """What is said of the predicates of ``goal``; empty where nothing is."""
    described = {atom.predicate for atom in goal if atom.predicate.description}
    return f"\n{titled('What this means:', meaning_lines(described).splitlines())}".rstrip()


def _numbered(shown: Iterable[View], heading: str, numbers: Iterator[int]) -> list[View]:
    """``shown`` with headings that end in ``Image <number>``."""
    return [replace(view, heading=f"{heading}Image {next(numbers)}") for view in shown]


def skill_line(skill: Skill, *, explained: bool = False) -> str:
    """``Push(robot, box)[-3.14 to 3.14]`` with the numbers' ranges; ``explained`` with what the skill needs and does.

    The published protocol explains nothing.
    """
    ranges = ", ".join(f"{low:g} to {high:g}" for low, high in zip(skill.low, skill.high, strict=True))
    line = f"{skill.name}({', '.join(t.name for t in skill.types)})[{ranges}]"
    return f"{line}: {skill.description}" if explained and skill.description else line


def type_lines(types: Sequence[Type]) -> str:
    """The hierarchy as PDDL writes it: ``patty lettuce - item``."""
    by_parent: dict[str, list[str]] = {}
    for kind in types:
        by_parent.setdefault(kind.parent.name if kind.parent else "", []).append(kind.name)
    return "\n".join(
        " ".join(sorted(names)) + (f" - {parent}" if parent else "") for parent, names in sorted(by_parent.items())
    )


def goal_lines(goals: Sequence[Iterable[Atom]]) -> str:
    """One atom per line, in the names of the prompt; of several goals, of which one is enough, one line with all."""
    ways = [[f"{a.predicate.name}({', '.join(o.prompt_name for o in a.objects)})" for a in goal] for goal in goals]
    return "\n".join(ways[0]) if len(ways) == 1 else " or ".join(f"({' and '.join(way)})" for way in ways)


def example_text(number: int, demo: Demo) -> str:
    """What a demonstration did."""
    actions = "\n".join(f"action {t} from state {t} is {written(a)}" for t, a in enumerate(demo.actions))
    return fill("vila_example", ROOM, number=str(number), goal=goal_lines(demo.goals), actions=actions)


def written(action: Action) -> str:
    """An action as a plan line."""
    objects = ", ".join(f"{o.prompt_name}:{o.type.name}" for o in action.objects)
    return f"{action.skill.name}({objects})[{', '.join(f'{p:.4g}' for p in action.params)}]"


def _episode(
    task: Task, failure: Failure | None, detail: str, plan: WrittenPlan, steps: Sequence[ExecutedStep]
) -> Episode:
    return Episode(
        task.name, failure, detail, tuple(str(a) for a in plan.actions), tuple(steps), (), (), nodes=None
    )  # fmt: skip
