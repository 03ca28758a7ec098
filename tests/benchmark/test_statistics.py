"""Hand-worked figures for intervals, tests and cells."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pix2pred.benchmark.rows import Row, TryOutcome
from pix2pred.benchmark.statistics import TableCell, cell, sign_test, wilson


def row(seed: int, outcome: TryOutcome, cause: str = "") -> Row:
    return Row("ours", "combo", None, seed, "t" if outcome.scored else None, outcome, cause=cause, labels=2)


def test_wilson_intervals_known_by_heart() -> None:
    """81 of 263: 0.2553 to 0.3662 (Newcombe, Statistics in Medicine 17, 1998, table I)."""
    assert (round(wilson(81, 263).low, 4), round(wilson(81, 263).high, 4)) == (0.2553, 0.3662)
    assert (round(wilson(0, 20).low, 4), round(wilson(0, 20).high, 4)) == (0.0, 0.1611)


@given(st.integers(1, 60).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_an_interval_holds_the_share_and_lies_within_0_and_1(case: tuple[int, int]) -> None:
    successes, tries = case
    interval = wilson(successes, tries)
    assert 0 <= interval.low <= successes / tries + 1e-12 and successes / tries - 1e-12 <= interval.high <= 1


def test_no_tries_have_no_share() -> None:
    with pytest.raises(ValueError, match="0 of 0"):
        wilson(0, 0)


def test_sign_test() -> None:
    assert sign_test(0, 0) == 1
    assert sign_test(5, 0) == pytest.approx(0.0625)
    assert sign_test(8, 1) == pytest.approx(2 * 10 / 512)
    assert sign_test(3, 3) == 1


def test_a_cell_counts_per_seed_and_names_causes() -> None:
    rows = [row(0, TryOutcome.SOLVED), row(0, TryOutcome.FAILED, "wrong label"), row(1, TryOutcome.SOLVED),
            row(1, TryOutcome.SOLVED), row(2, TryOutcome.BUDGET, "budget"), row(2, TryOutcome.SOLVED)]  # fmt: skip
    found = cell(rows)
    assert isinstance(found, TableCell)
    assert (found.tries, found.by_seed, found.solved, found.labels) == (6, (1, 2, 1), 4, 12)
    assert found.mean == pytest.approx(4 / 3) and round(found.sd, 4) == 0.5774
    assert found.failures == {"wrong label": 1, "budget": 1}


def test_what_was_not_tried_is_no_zero() -> None:
    assert cell([]) is None
    assert cell([row(0, TryOutcome.NEEDS_MODEL)]) == TryOutcome.NEEDS_MODEL
    assert cell([row(0, TryOutcome.NOT_AVAILABLE)]) == TryOutcome.NOT_AVAILABLE


def test_one_seed_has_no_deviation() -> None:
    found = cell([row(0, TryOutcome.SOLVED)])
    assert isinstance(found, TableCell) and found.sd == 0 and found.text == "1.0 ± 0.0"
