"""What rows say in numbers: means over seeds, standard deviations, intervals, and a paired test between two runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import mean, stdev

from pix2pred.benchmark.rows import Row, TryOutcome


@dataclass(frozen=True, slots=True)
class Interval:
    """A 95 % confidence interval of a share."""

    low: float
    high: float


def wilson(successes: int, tries: int) -> Interval:
    """The score interval of a share (Wilson, 1927): sensible at 0 and 1, where the sd over seeds is 0."""
    from scipy.stats import binomtest  # takes half a second to import

    if tries == 0:
        raise ValueError("0 of 0 is no share")
    found = binomtest(successes, tries).proportion_ci(method="wilson")
    return Interval(float(found.low), float(found.high))


def sign_test(wins: int, losses: int) -> float:
    """Two-sided p-value that ``wins`` and ``losses`` come from a fair coin (exact McNemar test of paired tries)."""
    from scipy.stats import binomtest

    return float(binomtest(wins, wins + losses).pvalue) if wins + losses else 1.0


@dataclass(frozen=True, slots=True)
class TableCell:
    """All tries of one approach on one family (at one value of the axis).

    ``by_seed`` counts solved tasks per seed; ``mean`` and ``sd`` are over seeds, ``interval`` is of the share of all
    tries. ``sd`` is the sample standard deviation, 0 for a single seed.
    """

    tries: int
    by_seed: tuple[int, ...]
    failures: Counter[str]
    label_errors: int
    labels: int

    @property
    def solved(self) -> int:
        """Solved tasks of all seeds."""
        return sum(self.by_seed)

    @property
    def mean(self) -> float:
        """Mean number of solved tasks per seed."""
        return mean(self.by_seed)

    @property
    def sd(self) -> float:
        """Standard deviation of the number of solved tasks per seed."""
        return stdev(self.by_seed) if len(self.by_seed) > 1 else 0.0

    @property
    def per_seed(self) -> float:
        """Tasks per seed."""
        return self.tries / len(self.by_seed)

    @property
    def interval(self) -> Interval:
        """Of the share of solved tasks."""
        return wilson(self.solved, self.tries)

    @property
    def text(self) -> str:
        """``9.8 ± 0.4``."""
        return f"{self.mean:.1f} ± {self.sd:.1f}"


def cell(rows: Iterable[Row]) -> TableCell | TryOutcome | None:
    """The tries among ``rows``; why there are none; or None for no rows at all."""
    found = list(rows)
    tried = [r for r in found if r.outcome.scored]
    if not tried:
        return found[0].outcome if found else None
    seeds = sorted({r.seed for r in tried})
    return TableCell(
        len(tried),
        tuple(sum(r.outcome == TryOutcome.SOLVED for r in tried if r.seed == seed) for seed in seeds),
        Counter(r.cause or r.failure for r in tried if r.outcome != TryOutcome.SOLVED),
        sum(r.label_errors for r in tried),
        sum(r.labels for r in tried),
    )


def cell_of(
    rows: Sequence[Row], approach: str, family: str, value: float | None = None
) -> TableCell | TryOutcome | None:
    """The cell of an approach and a family."""
    return cell(r for r in rows if (r.approach, r.family, r.value) == (approach, family, value))
