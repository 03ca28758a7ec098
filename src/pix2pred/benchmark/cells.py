"""One job of a benchmark: all approaches on one family, seed and value, so that they share what was drawn and labelled.

Every try is written as soon as it ends; a job that was killed goes on where it stopped.
"""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

from pix2pred.approaches.approach import Agent, Approach, ModelAgent, Training
from pix2pred.benchmark.causes import cause_of, training_errors
from pix2pred.benchmark.rows import Cause, Row, TryOutcome
from pix2pred.benchmark.suite import FamilyEntry, Suite
from pix2pred.benchmark.sweeps import NotAvailableError, Setting, installed, tasks_for, vary
from pix2pred.execution import TruthOf
from pix2pred.execution.explaining.diagnosis import check_labels
from pix2pred.execution.explaining.replayed_demos import TruthInDemo, truths_of_demos
from pix2pred.pipeline import LearningProblem
from pix2pred.predicates import EmptyProposalError, UnusableAnswersError
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.structs import Demo, Episode, Failure, Predicate
from pix2pred.structs.environment import Domain, Environment, Replayable, SimulatedTask
from pix2pred.vlm import VLM, AnswerStore, CountingVLM, StoredVLM, StoreMode


class Catalogue(Protocol):
    """Where names become objects. Survives pickling, because workers look the names up themselves."""

    def domain(self, name: str) -> Domain:
        """Raises ``UnknownNameError`` or ``ImportError``."""
        ...

    def vlm(self, spec: str, domain: str | None) -> VLM:
        """The model that ``--vlm`` names."""
        ...

    def writes(self, spec: str) -> bool:
        """Whether the model that ``--vlm`` names writes plans and code as well as labels."""
        ...

    def approach(self, name: str) -> Approach:
        """Raises ``UnknownNameError``."""
        ...

    def truth(self, domain: Domain, environment: Environment) -> TruthOf | None:
        """What the simulator knows about words in the environment's present state."""
        ...


@dataclass(frozen=True)
class Job:
    """A family at a seed and a value, for all approaches of ``suite``; ``folder`` is the run's."""

    folder: Path
    suite: Suite
    family: FamilyEntry
    seed: int
    value: float | None
    vlm: str
    answers: Path
    mode: StoreMode
    catalogue: Catalogue

    @property
    def place(self) -> str:
        """Where the job's cells are, inside the run folder."""
        value = "" if self.value is None else f"/{self.value:g}"
        return f"cells/{self.family.name}{value}/seed{self.seed}"

    @property
    def approaches(self) -> tuple[str, ...]:
        """What is compared on the family."""
        return self.suite.approaches_of(self.family)

    @cached_property
    def domain(self) -> Domain:
        """Raises ``NotAvailableError``."""
        return installed(self.family.domain, self.catalogue.domain)

    @cached_property
    def family_name(self) -> str:
        """The domain's name of the family. Raises ``NotAvailableError``."""
        name = self.family.family or self.domain.families[0]
        if name not in self.domain.families:
            raise NotAvailableError(f"domain {self.family.domain!r} has no family {name!r}")
        return name

    @cached_property
    def demos(self) -> Sequence[Demo]:
        """All demonstrations of the family and seed."""
        return self.domain.demonstrations(self.family_name, self.seed)

    @cached_property
    def starts(self) -> Sequence[SimulatedTask] | None:
        """The starts of the demonstrations, for a domain whose demonstrations can be visited again."""
        if not isinstance(self.domain, Replayable):
            return None
        return self.domain.demonstration_starts(self.family_name, self.seed)

    @cached_property
    def tasks(self) -> Sequence[SimulatedTask]:
        """The test tasks. Raises ``NotAvailableError``."""
        return tasks_for(
            self.domain, self.family_name, self.seed, self.suite.tasks_of(self.family), self.suite.axis, self.value
        )

    @cached_property
    def model(self) -> CountingVLM:
        """The model behind the answer store, counted."""
        model = self.catalogue.vlm(self.vlm, self.family.domain)
        return CountingVLM(StoredVLM(model, AnswerStore(self.answers), self.mode))

    def rows(self) -> list[Row]:
        """The rows that exist, with those that stand for whole cells that cannot be run."""
        found = []
        for name in self.approaches:
            if reason := self.excluded(name):
                found.append(self.row(name, None, *reason))
                continue
            cell = self.folder / self.place / name
            for path in (*cell.glob("cell.json"), *sorted(cell.glob("task-*.json"))):
                found.append(Row.from_document(json.loads(path.read_text(encoding="utf-8"))))
        return found

    def excluded(self, name: str) -> tuple[TryOutcome, str] | None:
        """Why the approach ``name`` is not tried here at all, or None."""
        try:
            assert self.family_name, "a family has a name"
        except NotAvailableError as error:
            return TryOutcome.NOT_AVAILABLE, str(error)
        if self.catalogue.approach(name).needs_model and not self.catalogue.writes(self.vlm):
            return TryOutcome.NEEDS_MODEL, f"{self.model.name} neither plans nor writes code"
        return None

    def finished(self, name: str) -> bool:
        """Whether ``name`` has been tried on everything. Raises ``RunFolderError`` for what another model made."""
        cell = self.folder / self.place / name
        learned = cell / "learned.json"
        if not learned.exists():
            return (cell / "cell.json").exists()
        made_with = str(json.loads(learned.read_text(encoding="utf-8"))["labels_from"])
        if not made_with.startswith(self.model.name):  # the name of flipped labels begins with the model's
            raise RunFolderError(
                f"{self.folder}: {self.place}/{name} was made with {made_with}, not {self.model.name}; "
                "choose another folder with --out"
            )
        return all((cell / f"task-{i:03d}.json").exists() for i in range(self.suite.tasks_of(self.family)))

    def row(self, name: str, task: str | None, outcome: TryOutcome, detail: str) -> Row:
        """The row of a try of the approach ``name``; without a ``task``, of an approach that is not tried."""
        return Row(name, self.family.name, self.value, self.seed, task, outcome, detail=detail)


@dataclass(frozen=True, slots=True)
class Done:
    """The seconds and queries that a job took."""

    place: str
    seconds: float
    queries: dict[str, dict[str, int]]


def run_job(job: Job) -> Done:
    """Run what is missing of a job. Raises ``VLMError`` when the model cannot be asked."""
    start, tried = time.perf_counter(), 0
    run = RunFolder(job.folder)
    for name in job.approaches:
        if job.excluded(name) is None and not job.finished(name):
            try:
                tried += _Cell(job, name, run).finish()
            except NotAvailableError as error:
                row = job.row(name, None, TryOutcome.NOT_AVAILABLE, str(error))
                run.write_json(f"{job.place}/{name}/cell.json", row.document())
    seconds = round(time.perf_counter() - start, 3)
    queries = job.model.usage.as_dict() if tried else {}
    return Done(job.place, seconds, queries)


class _Cell:
    """One approach of a job."""

    def __init__(self, job: Job, name: str, run: RunFolder) -> None:
        self._job = job
        self._name = name
        self._run = run
        self._place = f"{job.place}/{name}"
        axis, value = job.suite.axis, job.value
        self._setting = vary(Setting(job.catalogue.approach(name), job.demos, job.model), axis, value, job.seed)
        self._tasks = job.tasks

    def finish(self) -> int:
        """Run the tasks that have no row yet; gives their number."""
        missing = [i for i in range(len(self._tasks)) if not self._path(i).exists()]
        try:
            agent: Agent | str = self._train()
        except (EmptyProposalError, UnusableAnswersError) as error:
            agent = str(error)
        if isinstance(agent, str):
            self._write_learned({"error": agent})
        else:
            self._write_learned(dict(agent.summary) | self._training_errors(agent))
        for i in missing:
            row = self._failed(i, agent) if isinstance(agent, str) else self._try(i, agent)
            self._run.write_json(f"{self._place}/task-{i:03d}.json", row.document())
        return len(missing)

    def _path(self, i: int) -> Path:
        return self._run.path / self._place / f"task-{i:03d}.json"

    def _write_learned(self, summary: dict[str, Any]) -> None:
        self._run.write_json(f"{self._place}/learned.json", {"labels_from": self._setting.vlm.name, **summary})

    def _train(self) -> Agent:
        job = self._job
        problem = LearningProblem(
            job.domain.vocabulary(job.family_name),
            self._setting.demos,
            self._setting.vlm,
            job.suite.settings_of(job.family, job.domain.settings(job.family_name)),
        )
        planner = job.suite.budgets.planner()
        return self._setting.approach.train(Training(problem, planner, job.family.shown_demos))

    def _try(self, i: int, agent: Agent) -> Row:
        stored = self._tasks[i]
        environment = self._job.domain.environment(stored.task, stored.simulator)
        environment.reset()
        truth = self._job.catalogue.truth(self._job.domain, environment)
        try:
            episode = agent.solve(stored.task, environment, truth)
        except UnusableAnswersError as error:
            return self._failed(i, str(error))
        return self._row(stored, episode, agent, environment, truth)

    def _row(
        self, stored: SimulatedTask, episode: Episode, agent: Agent, environment: Environment, truth: TruthOf | None
    ) -> Row:
        outcome = TryOutcome.SOLVED if episode.solved else TryOutcome.FAILED
        known = wrong = 0
        cause: Cause | str = ""
        modelled = agent.plans_with
        if modelled is not None:
            environment.reset()
            check = check_labels(truth, frozenset(episode.labels), stored.task, modelled.model)
            known, wrong = check.known, len(check.wrong)
            if not episode.solved:
                cause = cause_of(
                    episode, check, modelled, stored.task, environment, truth, lambda: self._relearned(modelled)
                )
        elif not episode.solved:
            cause = Cause.UNDETERMINED
        if episode.failure == Failure.BUDGET:
            outcome = TryOutcome.BUDGET
        row = self._job.row(self._name, stored.task.name, outcome, episode.detail)
        return replace(
            row, failure=str(episode.failure or ""), cause=str(cause), plan_length=len(episode.plan),
            nodes=episode.nodes, labels=known, label_errors=wrong,
        )  # fmt: skip

    def _failed(self, i: int, why: str) -> Row:
        row = self._job.row(self._name, self._tasks[i].task.name, TryOutcome.FAILED, " ".join(why.split())[:300])
        return replace(row, failure="no answer")

    def _truth_in_demos(self, predicates: Sequence[Predicate]) -> TruthInDemo | None:
        domain = self._job.domain
        if self._job.starts is None:
            return None
        return truths_of_demos(
            self._setting.demos,
            self._job.starts,
            lambda start: domain.environment(start.task, start.simulator),
            lambda environment: self._job.catalogue.truth(domain, environment),
            predicates,
        )

    def _training_errors(self, agent: Agent) -> dict[str, int]:
        modelled = agent.plans_with
        if modelled is None:
            return {}
        truth = self._truth_in_demos([c.predicate for c in modelled.learned.labelling.table.pool])
        return dict(training_errors(modelled, truth)) if truth else {}

    def _relearned(self, agent: ModelAgent) -> ModelAgent | None:
        if not hasattr(self, "_better"):
            truth = self._truth_in_demos([c.predicate for c in agent.learned.labelling.table.pool])
            self._better = agent.relearned(truth) if truth else None
        return self._better
