"""What a benchmark compares: an approach trains on demonstrations and gives an agent, which solves tasks (method 9)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from pix2pred.execution import Solver, TruthOf
from pix2pred.execution.explaining.replayed_demos import TruthInDemo
from pix2pred.pipeline import Chooser, Learned, LearningProblem, Pool, PoolMaker, Selected, climb, fit_samplers, learn
from pix2pred.planning import TaskPlanner
from pix2pred.predicates import labeller_for
from pix2pred.settings import Settings
from pix2pred.structs import Episode, FromVLM, Label, LabelledDemo, Task, TruthTable, WorldModel
from pix2pred.structs.environment import Environment
from pix2pred.system.progress import silent
from pix2pred.vlm import Together


@dataclass(frozen=True, slots=True)
class Training:
    """What every approach gets: the same problem of learning, and the same planner for the tasks after it.

    ``shown_demos`` bounds the demonstrations that a prompt shows, where a model's context is limited.
    """

    problem: LearningProblem
    planner: TaskPlanner
    shown_demos: int | None = None


class Agent(Protocol):
    """Solves tasks after training."""

    @property
    def plans_with(self) -> ModelAgent | None:
        """The agent whose world model makes the plans, if there is one: failures are looked into with it."""
        ...

    @property
    def summary(self) -> Mapping[str, Any]:
        """What was learned, in numbers and names, JSON-compatible."""
        ...

    def solve(self, task: Task, environment: Environment, truth: TruthOf | None) -> Episode:
        """One task, one try. ``truth`` serves only to name the cause of a failure."""
        ...


class Approach(Protocol):
    """A way to solve tasks after demonstrations.

    ``needs_model``: the outcome depends on how a model proposes, plans or writes code, so that the offline reader's
    would say nothing.
    """

    @property
    def name(self) -> str:
        """What suites and rows call it."""
        ...

    @property
    def needs_model(self) -> bool:
        """See above."""
        ...

    def train(self, training: Training) -> Agent:
        """Learn from the demonstrations. Raises what ``pipeline.learn`` raises."""
        ...


@dataclass(frozen=True, slots=True)
class ModelAgent:
    """Plans with a learned world model."""

    training: Training
    learned: Learned
    choose: Chooser

    @property
    def plans_with(self) -> ModelAgent:
        return self

    @property
    def model(self) -> WorldModel:
        """The world model."""
        return self.learned.model

    @property
    def summary(self) -> Mapping[str, Any]:
        table, selection = self.learned.labelling.table, self.learned.selection
        return {
            "candidates": len(table.candidates()),
            "selected": [p.name for p in selection.selected],
            "visual": sum(isinstance(p.source, FromVLM) for p in selection.selected),
            "operators": len(selection.operators),
            "J": [round(step.j, 4) for step in selection.steps],
            "budget_hits": selection.budget_hits,
        }

    def solve(self, task: Task, environment: Environment, truth: TruthOf | None) -> Episode:
        """Open loop, as the paper does in simulation."""
        problem = self.training.problem
        labeller = labeller_for(problem.vlm, problem.settings.labels, Together(problem.settings.flow.concurrent))
        solver = Solver(self.model, self.training.planner, labeller, samplers=self.learned.samplers)
        return solver.solve(task, environment, truth)

    def relearned(self, truth: TruthInDemo) -> ModelAgent:
        """What would have been learned if every label with a known truth had been right."""
        table = self.learned.labelling.table
        demos = tuple(_corrected(d, demo, truth) for d, demo in enumerate(table.demos))
        right = TruthTable(table.initial, table.pool, demos)
        selection = self.choose(right, self.training.problem.settings.learning, silent)
        model = replace(self.model, selected=selection.selected, operators=selection.operators)
        labelling = replace(self.learned.labelling, table=right)
        selected = Selected(model, right, selection)
        samplers = fit_samplers(self.training.problem, selected)
        return replace(self, learned=Learned(self.learned.proposals, labelling, selected, samplers))


def _corrected(d: int, demo: LabelledDemo, truth: TruthInDemo) -> LabelledDemo:
    values = demo.values.copy()
    for i, atom in enumerate(demo.atoms):
        if isinstance(atom.predicate.source, FromVLM):
            for t in range(len(values)):
                known = truth(d, t, atom)
                if known is not None:
                    values[t, i] = Label.of(known)
    return replace(demo, values=values)


@dataclass(frozen=True, slots=True)
class Composition:
    """An approach that is the pipeline with its parts exchanged (method 9)."""

    name: str
    pool: PoolMaker
    choose: Chooser = climb
    needs_model: bool = False
    adjust: Callable[[Settings], Settings] = lambda settings: settings

    def limited(self, candidates: int, seed: int) -> Composition:
        """The same approach with that many of its visual candidates, drawn at random; smaller draws are subsets."""

        def pool(problem: LearningProblem) -> Pool:
            made = self.pool(problem)
            visual = [c for c in made.candidates if isinstance(c.predicate.source, FromVLM)]
            drawn = np.random.default_rng(seed).permutation(len(visual))[:candidates]
            kept = {visual[i].predicate for i in drawn}
            rest = tuple(c for c in made.candidates if c.predicate in kept or c not in visual)
            return Pool(rest, made.proposals)

        return replace(self, pool=pool)

    def train(self, training: Training) -> ModelAgent:
        problem = replace(training.problem, settings=self.adjust(training.problem.settings))
        learned = learn(problem, pool=self.pool, choose=self.choose)
        return ModelAgent(replace(training, problem=problem), learned, self.choose)
