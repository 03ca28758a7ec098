"""From pictures to symbols: proposing, labelling, and feature predicates."""

from pix2pred.predicates.abstraction import Abstraction
from pix2pred.predicates.correction_rows import CORRECTIONS, CorrectionsError
from pix2pred.predicates.corrections import Corrections, load_corrections
from pix2pred.predicates.grammar import GrammarSettings, feature_predicates
from pix2pred.predicates.labelling.asking import Gap, Occurrence
from pix2pred.predicates.labelling.evidence import EVIDENCE, EvidenceError, dump_evidence
from pix2pred.predicates.labelling.labeller import Labeller
from pix2pred.predicates.labelling.settings import LabelProtocol, LabelSettings
from pix2pred.predicates.labelling.state_labels import StateLabeller, StateLabels, StepToLabel, UnusableAnswersError
from pix2pred.predicates.labelling.table import Labelling, goal_warnings, ground_atoms, label_demos
from pix2pred.predicates.proposing.lift import lift
from pix2pred.predicates.proposing.propose import (
    EmptyProposalError,
    Proposal,
    ProposalSettings,
    ProposedAtom,
    Rejection,
    propose,
)
from pix2pred.predicates.protocols import labeller_for, proposed_pool

__all__ = [
    "CORRECTIONS",
    "EVIDENCE",
    "Abstraction",
    "Corrections",
    "CorrectionsError",
    "EmptyProposalError",
    "EvidenceError",
    "Gap",
    "GrammarSettings",
    "LabelProtocol",
    "LabelSettings",
    "Labeller",
    "Labelling",
    "Occurrence",
    "Proposal",
    "ProposalSettings",
    "ProposedAtom",
    "Rejection",
    "StateLabeller",
    "StateLabels",
    "StepToLabel",
    "UnusableAnswersError",
    "dump_evidence",
    "feature_predicates",
    "goal_warnings",
    "ground_atoms",
    "label_demos",
    "labeller_for",
    "lift",
    "load_corrections",
    "propose",
    "proposed_pool",
]
