"""Transitions told apart by given predicates, those that a model labels included (method 5.7).

In a project of photos every given predicate is labelled by the model. Its labels are repaired twice before they tell
transitions apart: along the demonstrations, by a hidden Markov model that knows skills and their arguments alone and
therefore allows an effect on any object; then where a kind of transition would be needed for one wrong label
(``labels/consistent.py``).
"""

from __future__ import annotations

from collections.abc import Sequence

from pix2pred.learning.labels.consistent import consistent
from pix2pred.learning.labels.hidden_markov import HiddenMarkovLabels
from pix2pred.learning.operators.clustering import partition
from pix2pred.learning.operators.robust_settings import RobustSettings
from pix2pred.learning.operators.transition_class import Partition
from pix2pred.learning.transitions import IndexedTable


def told_apart(data: IndexedTable, exact: Sequence[int], noisy: Sequence[int], settings: RobustSettings) -> Partition:
    """Classes of transitions by their effects on given predicates: on ``exact`` ones as they are labelled, on ``noisy``
    ones as is most probable."""
    base = partition(data, exact)
    if not noisy:
        return base
    labels = HiddenMarkovLabels(settings.labels, settings.roles)
    smoothed = labels.fit(data, base, noisy, beyond=True)
    repaired = consistent(data.relabelled(smoothed.extensions), exact, data, noisy, settings.kinds)
    return partition(data.relabelled(repaired), sorted((*exact, *noisy)))
