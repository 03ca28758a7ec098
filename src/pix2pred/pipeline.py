"""The whole method on one page: from demonstrations to a world model, and from a task to an episode.

read -> propose (+ feature grammar) -> label -> correct -> select, learn operators -> samplers -> advice    here
abstract -> plan -> execute                                                    ``Solver`` (the room of execution)

The stages stand in this order. ``learn``, at the end, runs one after the other; ``runs`` calls them one by one and
saves what each gave.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from pix2pred.learning import Advice, LearningSettings, Selection, advise, hill_climbing
from pix2pred.learning.invariants import acquaint
from pix2pred.learning.operators.contrary_words import with_contrary_words
from pix2pred.learning.operators.shared_words import with_shared_words
from pix2pred.learning.samplers.learn import learn_samplers
from pix2pred.learning.strategies import stopping_rule
from pix2pred.predicates import (
    Corrections,
    Labelling,
    Proposal,
    feature_predicates,
    label_demos,
    labeller_for,
    proposed_pool,
)
from pix2pred.settings import Settings
from pix2pred.structs import Candidate, Demo, FromVLM, PictureError, Predicate, TruthTable, Vocabulary, WorldModel
from pix2pred.structs.samplers import Sampler
from pix2pred.system.progress import Progress, Stage, silent
from pix2pred.vlm import VLM, Together

NO_CORRECTIONS = Corrections()


@dataclass(frozen=True, slots=True)
class LearningProblem:
    """What one learning works on: declared names, demonstrations, the model to ask, settings, and who is told."""

    vocabulary: Vocabulary
    demos: Sequence[Demo]
    vlm: VLM
    settings: Settings
    progress: Progress = silent


@dataclass(frozen=True, slots=True)
class Pool:
    """Candidate predicates.

    Where a model was asked for them, ``proposals`` tell what it proposed about each demonstration and what of that was
    rejected.
    """

    candidates: tuple[Candidate, ...]
    proposals: tuple[Proposal, ...] = ()


@dataclass(frozen=True, slots=True)
class Gathered:
    """All that a model was asked for: its proposals, and its labels of their atoms in every state."""

    proposals: tuple[Proposal, ...]
    labelling: Labelling


@dataclass(frozen=True, slots=True)
class Selected:
    """What selection gives: a world ``model`` and how it was come by.

    ``table`` holds the labels that it was learned from, a person's corrections included.
    """

    model: WorldModel
    table: TruthTable
    selection: Selection


@dataclass(frozen=True, slots=True)
class Learned:
    """What was proposed, what the model said about it, and what was made of that, samplers by operator included."""

    proposals: tuple[Proposal, ...]
    labelling: Labelling
    selected: Selected
    samplers: Mapping[str, Sampler]

    @property
    def model(self) -> WorldModel:
        """The world model."""
        return self.selected.model

    @property
    def selection(self) -> Selection:
        """How selection went."""
        return self.selected.selection


PoolMaker = Callable[[LearningProblem], Pool]
"""Where the candidates come from."""


class Chooser(Protocol):
    """How predicates are chosen and operators learned from labels."""

    def __call__(
        self, table: TruthTable, settings: LearningSettings, progress: Progress, pinned: Sequence[Predicate] = ()
    ) -> Selection:
        """``pinned`` are candidates that have to be taken."""
        ...


def visual_pool(problem: LearningProblem) -> Pool:
    """What the model proposes (method 2). Raises ``EmptyProposalError`` when none of it is usable."""
    settings = problem.settings
    problem.progress(Stage.PROPOSE, 0, len(problem.demos), "")
    candidates, proposals = proposed_pool(
        problem.demos,
        problem.vocabulary.initial,
        problem.vlm,
        settings.proposal,
        settings.labels,
        Together(settings.flow.concurrent),
        problem.progress,
        max_pictures=settings.flow.max_pictures,
    )
    return Pool(candidates, proposals)


def feature_pool(problem: LearningProblem) -> Pool:
    """What the grammar makes of the objects' features (method 4); no model is asked."""
    return Pool(feature_predicates(problem.demos, problem.vocabulary.types, problem.settings.grammar))


def whole_pool(problem: LearningProblem) -> Pool:
    """Visual and feature predicates: the pool of the full method."""
    visual, features = visual_pool(problem), feature_pool(problem)
    return Pool((*visual.candidates, *features.candidates), visual.proposals)


def label(problem: LearningProblem, pool: Pool) -> Labelling:
    """The values of all initial and candidate atoms in all states (method 3-4).

    With ``lift_types``, candidates of one word about sibling types are then one candidate. Words that the model named
    as contraries are candidates, too.
    """
    settings = problem.settings
    problem.progress(Stage.LABEL, 0, len(problem.demos), "")
    labelling = label_demos(
        problem.demos,
        problem.vocabulary.initial,
        pool.candidates,
        labeller_for(problem.vlm, settings.labels, Together(settings.flow.concurrent), settings.flow.max_pictures),
        progress=problem.progress,
        max_atoms=settings.flow.max_atoms,
    )
    table = labelling.table
    if settings.learning.lift_types:
        table = with_shared_words(table, problem.vocabulary.skills)
    return replace(labelling, table=with_contrary_words(table))


def ask(problem: LearningProblem, pool: PoolMaker = whole_pool) -> Gathered:
    """Propose and label: the part of the method that asks the model (method 2-4).

    Raises ``PictureError`` for a state without readable pictures, ``EmptyProposalError`` when the model proposes
    nothing usable, ``UnusableAnswersError`` when it labels nothing, and ``VLMError`` when it cannot be asked.
    """
    for demo in problem.demos:
        for t, state in enumerate(demo.states):
            if not state.pictures:
                raise PictureError(f"demonstration {demo.name}: state {t} has no picture to ask about")
    made = pool(problem)
    return Gathered(made.proposals, label(problem, made))


def climb(
    table: TruthTable, settings: LearningSettings, progress: Progress = silent, pinned: Sequence[Predicate] = ()
) -> Selection:
    """Hill climbing on J (method 6.3)."""
    count = len(table.candidates())
    progress(Stage.SELECT, 0, count, "")
    selection = hill_climbing(table, settings, pinned=pinned).run(progress)
    if selection.evaluations <= 1:
        progress(Stage.SELECT, count, count, "none was tried")
    return selection


def select(
    vocabulary: Vocabulary,
    said: TruthTable,
    settings: LearningSettings,
    labels_from: str,
    corrections: Corrections = NO_CORRECTIONS,
    progress: Progress = silent,
    choose: Chooser = climb,
) -> Selected:
    """Correct what the model ``labels_from`` ``said``, select predicates and learn operators (method 5-6).

    Asks no model. Raises ``CorrectionsError`` when the corrections do not fit the table.
    """
    corrected = corrections.apply(said)
    selection = choose(corrected.table, settings, progress, corrected.pinned)
    model = world_model(vocabulary, corrected.table, selection, labels_from)
    return Selected(model, corrected.table, selection)


def world_model(vocabulary: Vocabulary, table: TruthTable, selection: Selection, labels_from: str) -> WorldModel:
    """The model that was selected, with what ``table`` shows about its labels and about what always holds."""
    predicates = (*vocabulary.initial, *selection.selected)
    known = acquaint(table, predicates, selection.operators)
    return WorldModel(
        vocabulary, selection.selected, selection.operators, labels_from, known.reliability, known.invariants
    )


def finished_before_it_began(problem: LearningProblem) -> float | None:
    """J with the given predicates alone, if selection would stop there without trying any candidate; else None.

    Also None when a given predicate has to be read from pictures, since nothing is asked here.
    """
    if any(isinstance(p.source, FromVLM) for p in problem.vocabulary.initial):
        return None
    table, settings = label(replace(problem, progress=silent), Pool(())).table, problem.settings.learning
    score = hill_climbing(table, settings).score(())
    return score.total if stopping_rule(settings).finished(score) else None


def fit_samplers(problem: LearningProblem, selected: Selected) -> Mapping[str, Sampler]:
    """Samplers of continuous parameters, by operator (method 7)."""
    fitter = problem.settings.samplers.fitter()
    return learn_samplers(selected.model.operators, problem.demos, selected.table.demos, fitter)


def advice(selected: Selected, settings: LearningSettings, progress: Progress = silent) -> Advice:
    """Which labels a person should look at first."""
    progress(Stage.DOUBT, 0, 1, "")
    found = advise(selected.table, settings, selected.selection.pinned, selected.selection.selected)
    progress(Stage.DOUBT, 1, 1, "")
    return found


def learn(
    problem: LearningProblem,
    corrections: Corrections = NO_CORRECTIONS,
    pool: PoolMaker = whole_pool,
    choose: Chooser = climb,
) -> Learned:
    """Learn a world model from demonstrations (method 2-7).

    ``pool`` and ``choose`` are the two places where the ablations of
    method 9 differ from the full method. Raises what ``ask`` and ``select`` raise.
    """
    asked = ask(problem, pool)
    table = asked.labelling.table
    selected = select(
        problem.vocabulary, table, problem.settings.learning, problem.vlm.name, corrections, problem.progress,
        choose,
    )  # fmt: skip
    return Learned(asked.proposals, asked.labelling, selected, fit_samplers(problem, selected))
