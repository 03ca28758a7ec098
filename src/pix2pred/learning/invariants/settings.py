"""The numbers of this room, with their reasons."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class AcquaintanceSettings:
    """How much demonstrations have to show. None of these numbers was tuned on a benchmark.

    ``prior_error`` is the error rate assumed before looking, and ``prior_labels`` the number of labels it counts for:
    what the repair of labels assumes, too. ``least_error`` keeps a predicate without a single wrong label in a few
    hundred from being trusted without limit. ``prior_states`` are imagined atoms of first states, half of them true
    (the prior of Krichevsky and Trofimov). ``least_support`` is the number of instances, and ``least_demos`` the number
    of demonstrations, in which an invariant has to be seen at work: fewer can agree by chance. ``largest_group`` bounds
    the atoms of a mutex group; no planning domain known to us needs more.
    """

    prior_error: float = 0.02
    prior_labels: float = 20.0
    least_error: float = 0.005
    prior_states: float = 1.0
    least_support: int = 6
    least_demos: int = 2
    largest_group: int = 4


DEFAULTS = AcquaintanceSettings()
