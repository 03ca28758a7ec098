"""Mutated answers through every parser; ``tools/fuzz_parsers.py --count 1000000`` is the long version."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fuzz_parsers
from pix2pred.predicates.labelling.parse_labels import parse_labels


@pytest.mark.parametrize("parser", fuzz_parsers.PARSERS)
@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 2**32), number=st.integers(0, 10**6))
def test_mutated_answers_break_nothing(parser: str, seed: int, number: int) -> None:
    fuzz_parsers.PARSERS[parser].check(fuzz_parsers.text_number(parser, seed, number))


@settings(max_examples=200, deadline=None)
@given(st.text(max_size=200) | st.lists(st.sampled_from(fuzz_parsers.PIECES), max_size=40).map("".join))
def test_random_texts_break_nothing(text: str) -> None:
    for fuzzed in fuzz_parsers.PARSERS.values():
        fuzzed.check(text)


def test_the_check_can_fail() -> None:
    for fuzzed in fuzz_parsers.PARSERS.values():
        for seed in fuzzed.seeds:
            fuzzed.check(seed)
    assert parse_labels(fuzz_parsers.LABELS[2], fuzz_parsers.QUERY).missing == ()
    assert len(parse_labels(fuzz_parsers.LABELS[0], fuzz_parsers.QUERY).values) == 5
