"""From pictures to symbols: proposing, labelling, and feature predicates."""

from pix2pred.predicates.grammar import GrammarSettings, feature_predicates
from pix2pred.predicates.label import Labeller, LabelSettings, StateLabels
from pix2pred.predicates.propose import (
    EmptyProposalError,
    Proposal,
    ProposalSettings,
    ProposedAtom,
    Rejection,
    lift,
    propose,
)
from pix2pred.predicates.table import Labelling, abstract, ground_atoms, label_demos

__all__ = [
    "EmptyProposalError",
    "GrammarSettings",
    "LabelSettings",
    "Labeller",
    "Labelling",
    "Proposal",
    "ProposalSettings",
    "ProposedAtom",
    "Rejection",
    "StateLabels",
    "abstract",
    "feature_predicates",
    "ground_atoms",
    "label_demos",
    "lift",
    "propose",
]
