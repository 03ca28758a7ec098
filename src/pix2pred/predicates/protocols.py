"""The two ways of asking a model, as objects: what proposes words, makes a pool of them, and labels states."""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.predicates.frugal.labeller import FrugalLabeller
from pix2pred.predicates.frugal.proposing import propose_words
from pix2pred.predicates.labelling.labeller import Labeller
from pix2pred.predicates.labelling.settings import LabelProtocol, LabelSettings
from pix2pred.predicates.labelling.state_labels import StateLabeller
from pix2pred.predicates.proposing.lift import lift
from pix2pred.predicates.proposing.propose import Proposal, ProposalSettings, propose
from pix2pred.structs import Candidate, Demo, Predicate
from pix2pred.system.progress import Progress, silent
from pix2pred.vlm import VLM, Together


def labeller_for(
    vlm: VLM, settings: LabelSettings, together: Together | None = None, max_pictures: int | None = None
) -> StateLabeller:
    """What labels states by the protocol that ``settings`` name, asking as much at once as ``together`` allows."""
    if settings.protocol is LabelProtocol.FRUGAL:
        return FrugalLabeller(vlm, settings, together or Together(), max_pictures)
    return Labeller(vlm, settings, together or Together())


def proposed_pool(
    demos: Sequence[Demo],
    initial: Sequence[Predicate],
    vlm: VLM,
    proposal: ProposalSettings,
    labels: LabelSettings,
    together: Together,
    progress: Progress = silent,
    *,
    max_pictures: int | None = None,
) -> tuple[tuple[Candidate, ...], tuple[Proposal, ...]]:
    """The candidates that a model proposes, and its proposals; names of ``initial`` predicates are not used again.

    The few predicates that a baseline asks for (variant ``specific``) are asked for as published in either protocol.
    Raises ``EmptyProposalError`` when nothing usable is proposed.
    """
    taken = [p.name for p in initial]
    if labels.protocol is LabelProtocol.FRUGAL and proposal.diverse:
        proposals = propose_words(demos, vlm, proposal, initial, max_pictures=max_pictures, progress=progress)
    else:
        proposals = propose(demos, vlm, proposal, together=together, max_pictures=max_pictures, progress=progress)
    return lift(proposals, taken), proposals
