"""The whole method on one page: from demonstrations to a world model, and from a task to an episode.

propose -> lift -> (+ feature grammar) -> label -> correct -> select and learn operators      learn()
abstract -> plan -> execute                                                        Solver (execution room)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pydantic import BaseModel, ConfigDict, Field

from pix2pred.learning import LearningSettings, Selection, hill_climbing
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
from pix2pred.structs import Demo, PictureError, TruthTable, Vocabulary, WorldModel
from pix2pred.vlm import VLM


class Settings(BaseModel):
    """Everything a run can be told. Frozen; the resolved settings are saved with every run."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    proposal: ProposalSettings = Field(default_factory=ProposalSettings)
    labels: LabelSettings = Field(default_factory=LabelSettings)
    grammar: GrammarSettings = Field(default_factory=GrammarSettings)
    learning: LearningSettings = Field(default_factory=LearningSettings)
    concurrent_queries: int = Field(4, ge=1, description="queries under way at once; never changes a result")


NO_CORRECTIONS = Corrections()

Progress = Callable[[str, int, int, str], None]
"""Called with (stage, done, total, what is going on)."""


@dataclass(frozen=True, slots=True)
class Selected:
    """A world model, the corrected labels it was learned from, and how selection went."""

    model: WorldModel
    table: TruthTable
    selection: Selection


@dataclass(frozen=True, slots=True)
class Learned:
    """What was proposed, what the model said about it, and what was made of that."""

    proposals: tuple[Proposal, ...]
    labelling: Labelling
    selected: Selected


def learn(
    vocabulary: Vocabulary,
    demos: Sequence[Demo],
    vlm: VLM,
    settings: Settings,
    progress: Progress = lambda stage, done, total, text: None,
    corrections: Corrections = NO_CORRECTIONS,
) -> Learned:
    """Learn a world model from demonstrations (method 2-6).

    Raises ``EmptyProposalError`` when the model proposes nothing usable, ``UnusableAnswersError`` when it labels
    nothing, ``VLMError`` when it cannot be asked, and ``PictureError`` for a state without readable pictures.
    """
    for demo in demos:
        for t, state in enumerate(demo.states):
            if not state.pictures:
                raise PictureError(f"demonstration {demo.name}: state {t} has no picture to ask about")
    jobs = settings.concurrent_queries
    progress("propose", 0, len(demos), "")
    proposals = propose(
        demos,
        vlm,
        settings.proposal,
        jobs=jobs,
        progress=lambda done, total, name: progress("propose", done, total, name),
    )
    visual = lift(proposals, taken=[p.name for p in vocabulary.initial])
    features = feature_predicates(demos, vocabulary.types, settings.grammar)
    progress("label", 0, len(demos), "")
    labelling = label_demos(
        demos,
        vocabulary.initial,
        (*visual, *features),
        Labeller(vlm, settings.labels),
        jobs=jobs,
        progress=lambda done, total, name: progress("label", done, total, name),
    )
    return Learned(
        proposals, labelling, select(vocabulary, labelling.table, settings.learning, vlm.name, corrections, progress)
    )


def select(
    vocabulary: Vocabulary,
    table: TruthTable,
    settings: LearningSettings,
    labels_from: str,
    corrections: Corrections = NO_CORRECTIONS,
    progress: Progress = lambda stage, done, total, text: None,
) -> Selected:
    """Select predicates and learn operators from what a model said, corrected (method 4-6). Asks no model.

    Raises ``CorrectionsError`` when the corrections do not fit the table.
    """
    corrected = corrections.apply(table)
    progress("select", 0, len(corrected.table.candidates()), "")
    climb = hill_climbing(corrected.table, settings, corrected.pinned)
    selection = climb.run(lambda done, total, name: progress("select", done, total, name))
    model = WorldModel(vocabulary, selection.selected, selection.operators, labels_from)
    return Selected(model, corrected.table, selection)
