"""The models that are simulated answer both protocols alike: same picture and atom, same value, same error."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from pix2pred.predicates import LabelProtocol, LabelSettings, ProposalSettings, StateLabels, ground_atoms, labeller_for
from pix2pred.predicates.frugal.proposing import propose_words
from pix2pred.predicates.proposing.lift import lift
from pix2pred.structs import FromVLM, Predicate
from pix2pred.structs.views import View
from pix2pred.vlm import VLM
from pix2pred.vlm.noise.flips import FlippingVLM
from pix2pred.vlm.noise.oracle import NoiseRates, NoisyOracle
from pix2pred.vlm.offline.prompt_format import KnownWord
from predicates.scripted import COOKED, PATTY, ROBOT, demo

WORDS = [
    KnownWord("cooked", ("patty",), "cooked", False),
    KnownWord("grilled", ("patty",), "cooked", False),
    KnownWord("raw", ("patty",), "cooked", True),
    KnownWord("busy", ("robot",), "busy", False),
]
BUSY = Predicate("busy0", (ROBOT,), FromVLM("busy"))


def truth(view: View, word: str, names: Sequence[str]) -> bool | None:
    """The first patty is cooked from state 3 on, the robot busy in odd states."""
    if word == "busy":
        return view.state % 2 == 1
    return (names[0] == "patty1" and view.state >= 3) != (word == "raw")


def labels(vlm: VLM, protocol: LabelProtocol) -> tuple[StateLabels, ...]:
    settings = LabelSettings(protocol=protocol, double_check=False, attempts=1, states_per_query=4)
    d = demo(actions=6)
    return labeller_for(vlm, settings).demo(d, ground_atoms([COOKED, BUSY], d.objects))


@pytest.mark.parametrize("rates", [NoiseRates(), NoiseRates(flip=0.3), NoiseRates(flip=0.2, unknown=0.3)])
def test_the_oracle_errs_alike_in_both_protocols(rates: NoiseRates) -> None:
    oracle = NoisyOracle(WORDS, truth, rates, seed=3)
    published, frugal = (labels(oracle, protocol) for protocol in LabelProtocol)
    assert [s.values for s in frugal] == [s.values for s in published]


def test_flipped_labels_are_the_same_in_both_protocols() -> None:
    right = NoisyOracle(WORDS, truth)
    published, frugal = (labels(FlippingVLM(right, 0.3, 1), protocol) for protocol in LabelProtocol)
    assert [s.values for s in frugal] == [s.values for s in published]
    assert [s.values for s in frugal] != [s.values for s in labels(right, LabelProtocol.FRUGAL)]


def test_missing_and_malformed_lines_are_asked_for_and_named() -> None:
    said = labels(NoisyOracle(WORDS, truth, NoiseRates(missing=0.5, malformed=0.5)), LabelProtocol.FRUGAL)
    assert sum(len(gap.atoms) for state in said for gap in state.gaps) == 2 * 3  # three atoms in two stretches


def test_the_oracle_defines_each_meaning_once() -> None:
    proposals = propose_words([demo()], NoisyOracle(WORDS, truth), ProposalSettings())
    pool = lift(proposals)
    assert [c.predicate.name for c in pool] == ["busy0", "cooked0"]
    assert pool[1].predicate.types == (PATTY,)
    assert pool[1].predicate.source == FromVLM("cooked", ("grilled",), ("raw",))
    assert pool[1].predicate.description
