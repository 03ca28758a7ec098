"""The whole method on one page: from demonstrations to a world model, and from a task to an episode.

propose -> lift -> (+ feature grammar) -> label -> correct -> select, learn operators, learn samplers    learn()
abstract -> plan -> execute                                                            Solver (execution room)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from pydantic import BaseModel, ConfigDict, Field

from pix2pred.learning import LearningSettings, Selection, hill_climbing
from pix2pred.learning.samplers.learn import learn_samplers
from pix2pred.learning.samplers.settings import SamplerSettings
from pix2pred.predicates import (
    Corrections,
    GrammarSettings,
    Labeller,
    Labelling,
    LabelSettings,
    Proposal,
    ProposalSettings,
    feature_predicates,
    label_demos,
    lift,
    propose,
)
from pix2pred.structs import Candidate, Demo, PictureError, Predicate, TruthTable, Vocabulary, WorldModel
from pix2pred.structs.samplers import Sampler
from pix2pred.vlm import VLM, FlowSettings, Together


class Settings(BaseModel):
    """Everything a run can be told. Frozen; the resolved settings are saved with every run."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    proposal: ProposalSettings = Field(default_factory=ProposalSettings)
    labels: LabelSettings = Field(default_factory=LabelSettings)
    grammar: GrammarSettings = Field(default_factory=GrammarSettings)
    learning: LearningSettings = Field(default_factory=LearningSettings)
    samplers: SamplerSettings = Field(default_factory=SamplerSettings)
    flow: FlowSettings = Field(default_factory=FlowSettings)


NO_CORRECTIONS = Corrections()

Progress = Callable[[str, int, int, str], None]
"""Called with (stage, done, total, what is going on)."""


def silent(stage: str, done: int, total: int, text: str) -> None:
    """Shows nothing."""


@dataclass(frozen=True, slots=True)
class Selected:
    """A world model, the corrected labels it was learned from, and how selection went."""

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


@dataclass(frozen=True, slots=True)
class Pool:
    """Candidate predicates and, when a model was asked, what it proposed and what was rejected."""

    candidates: tuple[Candidate, ...]
    proposals: tuple[Proposal, ...] = ()


PoolMaker = Callable[[Vocabulary, Sequence[Demo], VLM, Settings, Progress], Pool]
"""Where the candidates come from."""

Chooser = Callable[[TruthTable, LearningSettings, Progress, Sequence[Predicate]], Selection]
"""How predicates are chosen and operators learned from labels; the last are candidates that have to be taken."""


def visual_pool(
    vocabulary: Vocabulary, demos: Sequence[Demo], vlm: VLM, settings: Settings, progress: Progress = silent
) -> Pool:
    """What the model proposes (method 2). Raises ``EmptyProposalError`` when none of it is usable."""
    progress("propose", 0, len(demos), "")
    proposals = propose(
        demos,
        vlm,
        settings.proposal,
        together=Together(settings.flow.concurrent),
        progress=lambda done, total, name: progress("propose", done, total, name),
    )
    return Pool(lift(proposals, taken=[p.name for p in vocabulary.initial]), proposals)


def feature_pool(
    vocabulary: Vocabulary, demos: Sequence[Demo], vlm: VLM, settings: Settings, progress: Progress = silent
) -> Pool:
    """What the grammar makes of the objects' features (method 4); no model is asked."""
    return Pool(feature_predicates(demos, vocabulary.types, settings.grammar))


def whole_pool(
    vocabulary: Vocabulary, demos: Sequence[Demo], vlm: VLM, settings: Settings, progress: Progress = silent
) -> Pool:
    """Visual and feature predicates: the pool of the full method."""
    visual = visual_pool(vocabulary, demos, vlm, settings, progress)
    features = feature_pool(vocabulary, demos, vlm, settings, progress)
    return Pool((*visual.candidates, *features.candidates), visual.proposals)


def climb(
    table: TruthTable,
    settings: LearningSettings,
    progress: Progress = silent,
    pinned: Sequence[Predicate] = (),
) -> Selection:
    """Hill climbing on J (method 6.3)."""
    progress("select", 0, len(table.candidates()), "")
    climbing = hill_climbing(table, settings, pinned=pinned)
    return climbing.run(lambda done, total, name: progress("select", done, total, name))


def learn(
    vocabulary: Vocabulary,
    demos: Sequence[Demo],
    vlm: VLM,
    settings: Settings,
    progress: Progress = silent,
    *,
    corrections: Corrections = NO_CORRECTIONS,
    pool: PoolMaker = whole_pool,
    choose: Chooser = climb,
) -> Learned:
    """Learn a world model from demonstrations (method 2-7).

    ``pool`` and ``choose`` are the two places where the ablations of method 9 differ from the full method.

    Raises ``EmptyProposalError`` when the model proposes nothing usable, ``UnusableAnswersError`` when it labels
    nothing, ``VLMError`` when it cannot be asked, ``PictureError`` for a state without readable pictures, and
    ``CorrectionsError`` when ``corrections`` do not fit what the model said.
    """
    proposals, labelling = ask_everything(vocabulary, demos, vlm, settings, progress, pool)
    selected = select(vocabulary, labelling.table, settings.learning, vlm.name, corrections, progress, choose)
    samplers = learn_samplers(selected.model.operators, demos, selected.table.demos, settings.samplers.fitter())
    return Learned(proposals, labelling, selected, samplers)


def ask_everything(
    vocabulary: Vocabulary,
    demos: Sequence[Demo],
    vlm: VLM,
    settings: Settings,
    progress: Progress = silent,
    pool: PoolMaker = whole_pool,
) -> tuple[tuple[Proposal, ...], Labelling]:
    """The part of the method that asks the model: proposals and the truth table (method 2-4). Raises as ``learn``."""
    for demo in demos:
        for t, state in enumerate(demo.states):
            if not state.pictures:
                raise PictureError(f"demonstration {demo.name}: state {t} has no picture to ask about")
    made = pool(vocabulary, demos, vlm, settings, progress)
    progress("label", 0, len(demos), "")
    labelling = label_demos(
        demos,
        vocabulary.initial,
        made.candidates,
        Labeller(vlm, settings.labels, Together(settings.flow.concurrent)),
        progress=lambda done, total, name: progress("label", done, total, name),
    )
    return made.proposals, labelling


def select(
    vocabulary: Vocabulary,
    table: TruthTable,
    settings: LearningSettings,
    labels_from: str,
    corrections: Corrections = NO_CORRECTIONS,
    progress: Progress = silent,
    choose: Chooser = climb,
) -> Selected:
    """Select predicates and learn operators from what a model said, corrected (method 4-6). Asks no model.

    Raises ``CorrectionsError`` when the corrections do not fit the table.
    """
    corrected = corrections.apply(table)
    selection = choose(corrected.table, settings, progress, corrected.pinned)
    model = WorldModel(vocabulary, selection.selected, selection.operators, labels_from)
    return Selected(model, corrected.table, selection)
