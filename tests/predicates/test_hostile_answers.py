"""Mutated answers through every parser; ``tools/fuzz_parsers.py --count 1000000`` is the long version."""

from __future__ import annotations

import random

from hypothesis import given, settings
from hypothesis import strategies as st

import fuzz_parsers
from pix2pred.predicates.parse_labels import parse_labels


@settings(max_examples=300, deadline=None)
@given(st.integers(0, 2**32))
def test_mutated_answers_break_nothing(seed: int) -> None:
    fuzz_parsers.check(fuzz_parsers.mutated(random.Random(seed)))


@settings(max_examples=200, deadline=None)
@given(st.text(max_size=200) | st.lists(st.sampled_from(fuzz_parsers.PIECES), max_size=40).map("".join))
def test_random_texts_break_nothing(text: str) -> None:
    fuzz_parsers.check(text)


def test_the_check_can_fail() -> None:
    found = fuzz_parsers.check
    for seed in fuzz_parsers.SEEDS:
        found(seed)
    assert parse_labels(fuzz_parsers.SEEDS[2], fuzz_parsers.QUERY).missing == ()
    assert len(parse_labels(fuzz_parsers.SEEDS[0], fuzz_parsers.QUERY).values) == 5
