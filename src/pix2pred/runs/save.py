"""Writing what learning gave into a run folder. Nothing here learns, asks or decides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from pix2pred.learning import Advice, LearningSettings, advice_document, dump_traces, selection_document
from pix2pred.learning.samplers.file import dump_samplers
from pix2pred.pipeline import Gathered, LearningProblem, Selected
from pix2pred.planning.pddl.write import write_domain
from pix2pred.predicates import Proposal, dump_evidence
from pix2pred.runs.addresses import stores_of_pictures
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.layout import (
    ADVICE,
    AS_SAID,
    CONFIG,
    EVIDENCE,
    GAPS,
    HISTORY,
    MODEL,
    PDDL,
    PROPOSALS,
    SAMPLERS,
    SELECTION,
    TRACES,
)
from pix2pred.structs.formats.world_model import dump_model
from pix2pred.structs.samplers import Sampler
from pix2pred.vlm import AnswerStore


def save_proposals(run: RunFolder, proposals: Sequence[Proposal]) -> None:
    """Accepted and rejected atoms, per demonstration."""
    run.write_json(PROPOSALS, [_proposal_doc(p) for p in proposals])


def save_asked(run: RunFolder, problem: LearningProblem, asked: Gathered) -> None:
    """Proposals and labels as the model gave them, its explanations, and the gaps it left."""
    save_proposals(run, asked.proposals)
    labelling = asked.labelling
    run.write(AS_SAID, dump_traces(problem.vocabulary, labelling.table, problem.settings.learning.model_dump()))
    run.write(EVIDENCE, dump_evidence(problem.demos, labelling))
    run.write_json(GAPS, [asdict(gap) for gap in labelling.gaps])
    _keep_pictures(run, problem)


def save_selected(
    run: RunFolder,
    selected: Selected,
    samplers: Mapping[str, Sampler],
    advice: Advice,
    settings: LearningSettings,
    corrections: int,
) -> None:
    """Corrected labels, selection and world model; the selection also as that of so many ``corrections``."""
    model = selected.model
    document = selection_document(selected.selection, settings)
    run.write(TRACES, dump_traces(model.vocabulary, selected.table, settings.model_dump()))
    run.write_json(SELECTION, document)
    (run.path / SAMPLERS).unlink(missing_ok=True)  # samplers never lie beside a model they were not learned for
    run.write(MODEL, dump_model(model))
    run.write(PDDL, write_domain(model))
    if samplers:
        run.write_bytes(SAMPLERS, dump_samplers(samplers))
    run.write_json(f"{HISTORY}/{corrections:05d}.json", {"version": 1, "corrections": corrections} | document)
    run.write_json(ADVICE, advice_document(advice))


def _keep_pictures(run: RunFolder, problem: LearningProblem) -> None:
    """Keep the demonstrations' pictures that no store of the run has: replayed answers may come without theirs."""
    config = run.config() if (run.path / CONFIG).exists() else {}
    stores = [AnswerStore(folder) for folder in stores_of_pictures(run.path, config)]
    for demo in problem.demos:
        for image in (picture.image for state in demo.states for picture in state.pictures):
            if not any(store.blob(image.digest).exists() for store in stores):
                AnswerStore(run.path).keep_picture(image)


def _proposal_doc(proposal: Proposal) -> dict[str, Any]:
    meanings = {a.name: a.definition.meaning for a in proposal.accepted if a.definition and a.definition.meaning}
    return {
        "demo": proposal.demo,
        "accepted": [f"{a.name}({', '.join(o.name for o in a.objects)})" for a in proposal.accepted],
        "rejected": [{"text": r.text, "reason": r.reason} for r in proposal.rejected],
        **({"meanings": meanings} if meanings else {}),
        **({"problem": proposal.problem} if proposal.problem else {}),
    }
