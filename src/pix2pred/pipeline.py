"""The whole method on one page: from demonstrations to a world model, and from a task to an episode.

propose -> lift -> (+ feature grammar) -> label -> select, learn operators, learn samplers      learn()
abstract -> plan -> execute                                                                     Solver (execution room)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from pydantic import BaseModel, ConfigDict, Field

from pix2pred.learning import LearningSettings, Selection, hill_climbing
from pix2pred.learning.samplers import learn_samplers
from pix2pred.learning.samplers_settings import SamplerSettings
from pix2pred.predicates import (
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
from pix2pred.structs import Demo, PictureError, Vocabulary, WorldModel
from pix2pred.structs.samplers import Sampler
from pix2pred.vlm import VLM, FlowSettings


class Settings(BaseModel):
    """Everything a run can be told. Frozen; the resolved settings are saved with every run."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    proposal: ProposalSettings = Field(default_factory=ProposalSettings)
    labels: LabelSettings = Field(default_factory=LabelSettings)
    grammar: GrammarSettings = Field(default_factory=GrammarSettings)
    learning: LearningSettings = Field(default_factory=LearningSettings)
    samplers: SamplerSettings = Field(default_factory=SamplerSettings)
    flow: FlowSettings = Field(default_factory=FlowSettings)


Progress = Callable[[str, int, int, str], None]
"""Called with (stage, done, total, what is going on)."""


@dataclass(frozen=True, slots=True)
class Learned:
    """A world model and everything it came from."""

    model: WorldModel
    proposals: tuple[Proposal, ...]
    labelling: Labelling
    selection: Selection
    samplers: Mapping[str, Sampler]


def learn(
    vocabulary: Vocabulary,
    demos: Sequence[Demo],
    vlm: VLM,
    settings: Settings,
    progress: Progress = lambda stage, done, total, text: None,
) -> Learned:
    """Learn a world model from demonstrations (method 2-7).

    Raises ``EmptyProposalError`` when the model proposes nothing usable, ``UnusableAnswersError`` when it labels
    nothing, ``VLMError`` when it cannot be asked, and ``PictureError`` for a state without readable pictures.
    """
    proposals, labelling = ask_everything(vocabulary, demos, vlm, settings, progress)
    progress("select", 0, len(labelling.table.candidates()), "")
    climb = hill_climbing(labelling.table, settings.learning)
    selection = climb.run(lambda done, total, name: progress("select", done, total, name))
    model = WorldModel(vocabulary, selection.selected, selection.operators, vlm.name)
    samplers = learn_samplers(selection.operators, demos, labelling.table.demos, settings.samplers.fitter())
    return Learned(model, proposals, labelling, selection, samplers)


def ask_everything(
    vocabulary: Vocabulary,
    demos: Sequence[Demo],
    vlm: VLM,
    settings: Settings,
    progress: Progress = lambda stage, done, total, text: None,
) -> tuple[tuple[Proposal, ...], Labelling]:
    """The part of the method that asks the model: proposals and the truth table (method 2-4). Raises as ``learn``."""
    for demo in demos:
        for t, state in enumerate(demo.states):
            if not state.pictures:
                raise PictureError(f"demonstration {demo.name}: state {t} has no picture to ask about")
    jobs = settings.flow.concurrent
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
    return proposals, labelling
