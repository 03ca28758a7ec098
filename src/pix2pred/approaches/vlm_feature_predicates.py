"""The model writes classifiers over object features; hill climbing chooses among them (like InterPreT).

What the classifiers say is kept as given values of the states, so that everything after the pool is the same pipeline;
the code itself runs in the sandbox alone and is never part of a world model.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any

from pix2pred.approaches.approach import ModelAgent, Training
from pix2pred.approaches.parse_code import CodePredicate, distinct, parse_code
from pix2pred.approaches.sandbox import CodeError, SandboxLimits, run_classifier
from pix2pred.approaches.vila import ROOM, type_lines
from pix2pred.execution import TruthOf
from pix2pred.pipeline import LearningProblem, Pool, climb, learn
from pix2pred.predicates import ground_atoms
from pix2pred.predicates.frugal.definitions import skill_lines
from pix2pred.predicates.labelling.settings import LabelProtocol
from pix2pred.predicates.prompt import action_text, fill, meaning_lines, object_lines, titled, type_meanings, views
from pix2pred.predicates.proposing.propose import Rejection
from pix2pred.structs import (
    Atom,
    Candidate,
    Demo,
    Episode,
    FromDomain,
    Object,
    Predicate,
    State,
    Task,
    Vocabulary,
)
from pix2pred.structs.environment import Environment
from pix2pred.structs.views import LONGEST_SIDE
from pix2pred.system.progress import Stage
from pix2pred.vlm import Purpose, Request

ANSWER_TOKENS = 8192
LIMITS = SandboxLimits()

KINDS_AS_PUBLISHED = "each type after the arrow is a kind of the one before it"
KINDS_BY_DASH = "where a line has a dash, the types before it are kinds of the type after it"
"""How to read the lines of types, which have dashes; the published prompt says arrow."""


@dataclass(frozen=True, slots=True)
class CodePool:
    """Predicates that work on all demonstrations, with their code, and what was rejected and why."""

    code: Mapping[Predicate, CodePredicate]
    rejected: tuple[Rejection, ...]

    def values(self, states: Sequence[State], objects: Sequence[Object], limits: SandboxLimits) -> list[State]:
        """``states`` with the atoms that the classifiers find true among the given ones; failing code finds none."""
        found = list(states)
        for predicate, code in self.code.items():
            try:
                found = with_values(found, predicate, code, objects, limits)
            except CodeError:
                continue
        return found


@dataclass(frozen=True, slots=True)
class VLMFeaturePredicates:
    """Implements ``Approach``."""

    name: str = "vlm-feature-predicates"
    needs_model: bool = True
    limits: SandboxLimits = LIMITS

    def train(self, training: Training) -> CodeAgent:
        """Raises ``SandboxError`` where code cannot be confined."""
        pool, demos = self.written_pool(training.problem)
        candidates = tuple(Candidate(p, float(p.arity)) for p in pool.code)
        problem = replace(training.problem, demos=demos)
        learned = learn(problem, pool=lambda _: Pool(candidates))
        return CodeAgent(ModelAgent(replace(training, problem=problem), learned, climb), pool, self.limits)

    def written_pool(self, problem: LearningProblem) -> tuple[CodePool, tuple[Demo, ...]]:
        """What the model writes and what of it works, and the demonstrations with its values."""
        types = {t.name: t for t in problem.vocabulary.types}
        shown, explained = problem.settings.proposal, problem.settings.labels.protocol is LabelProtocol.FRUGAL
        written: list[CodePredicate] = []
        rejected: list[Rejection] = []
        for i, demo in enumerate(problem.demos):
            problem.progress(Stage.PROPOSE, i, len(problem.demos), demo.name)
            answer = problem.vlm.answer(
                code_request(
                    demo, problem.vocabulary, marks=shown.marks, longest_side=shown.longest_side, explained=explained
                )
            )
            found, bad = parse_code(answer.text, types)
            written += found
            rejected += bad
        taken = {p.name for p in problem.vocabulary.initial}
        code: dict[Predicate, CodePredicate] = {}
        demos = list(problem.demos)
        for one in distinct(written):
            predicate = Predicate(_free_name(one.name, taken), one.types, FromDomain())
            try:
                demos = [
                    replace(d, states=tuple(with_values(d.states, predicate, one, d.objects, self.limits)))
                    for d in demos
                ]
            except CodeError as error:
                rejected.append(Rejection(one.source, str(error)))
                continue
            taken.add(predicate.name)
            code[predicate] = one
        return CodePool(code, tuple(rejected)), tuple(demos)


@dataclass(frozen=True, slots=True)
class CodeAgent:
    """Plans with the learned model; classifiers run on the features of the task's initial state."""

    agent: ModelAgent
    pool: CodePool
    limits: SandboxLimits

    @property
    def plans_with(self) -> ModelAgent:
        return self.agent

    @property
    def summary(self) -> Mapping[str, Any]:
        return {
            **self.agent.summary,
            "written": len(self.pool.code),
            "rejected": [r.reason for r in self.pool.rejected],
        }

    def solve(self, task: Task, environment: Environment, truth: TruthOf | None) -> Episode:
        used = {p: c for p, c in self.pool.code.items() if p in self.agent.model.selected}
        (initial,) = CodePool(used, ()).values([task.initial], task.objects, self.limits)
        return self.agent.solve(replace(task, initial=initial), environment, truth)


def with_values(
    states: Sequence[State], predicate: Predicate, code: CodePredicate, objects: Sequence[Object], limits: SandboxLimits
) -> list[State]:
    """``states`` with the atoms of ``predicate`` that its code finds true. Raises ``CodeError``."""
    atoms = ground_atoms([predicate], objects)
    queries = [(number, atom.objects) for number in range(len(states)) for atom in atoms]
    types = sorted({kind.name for o in objects for kind in o.type.lineage})
    values = run_classifier(code.source, code.function, types, [s.features for s in states], queries, limits)
    true: list[set[Atom]] = [set() for _ in states]
    for (number, args), value in zip(queries, values, strict=True):
        if value:
            true[number].add(Atom(predicate, args))
    return [replace(s, given=s.given | frozenset(found)) for s, found in zip(states, true, strict=True)]


def code_request(
    demo: Demo, vocabulary: Vocabulary, *, marks: bool, longest_side: int = LONGEST_SIDE, explained: bool = False
) -> Request:
    """The query about one demonstration; ``explained`` with what types, features, skills and given predicates mean.

    The published protocol explains nothing.
    """
    holders = [t for t in vocabulary.types if t.features]
    features = "\n".join(f"{t.name}: {', '.join(t.features)}" for t in holders)
    text = fill(
        "code",
        ROOM,
        example_type=holders[0].name if holders else vocabulary.types[0].name,
        kinds=KINDS_BY_DASH if explained else KINDS_AS_PUBLISHED,
        types=f"{features}\n{type_lines(vocabulary.types)}" + (_explanations(vocabulary) if explained else ""),
        objects=object_lines(demo.objects),
        trajectory="\n".join(_trajectory(demo)),
    )
    shown = (views(s, t, demo.objects, marks=marks, longest_side=longest_side) for t, s in enumerate(demo.states))
    pictures = list(chain.from_iterable(shown))
    cameras = [p.camera for p in demo.states[0].pictures][:1]
    return Request(Purpose.CODE, (text, *(v for v in pictures if v.picture.camera in cameras)), ANSWER_TOKENS)


def _explanations(vocabulary: Vocabulary) -> str:
    measured = [f"- {t.name}: {t.measures}" for t in vocabulary.types if t.measures]
    return (
        f"\n{type_meanings(vocabulary.types)}"
        + titled("What features mean, of a type and its kinds:", measured)
        + titled("Skills of the robot:", skill_lines(vocabulary.skills).splitlines())
        + titled("Known already; write neither these nor the contrary:", meaning_lines(vocabulary.initial).splitlines())
    ).rstrip()


def _trajectory(demo: Demo) -> Iterable[str]:
    for t, state in enumerate(demo.states):
        yield f"state {t}:"
        for thing, values in sorted(state.features.items()):
            pairs = ", ".join(f"{f}={v:.4g}" for f, v in zip(thing.type.features, values, strict=True))
            yield f"  {thing.prompt_name}: {pairs}"
        if t < len(demo.actions):
            yield f"skill: {action_text(demo.actions[t])}"


def _free_name(name: str, taken: set[str]) -> str:
    number = 0
    while f"{name}{number}" in taken:
        number += 1
    return f"{name}{number}"


VLM_FEATURE_PREDICATES = VLMFeaturePredicates()
