"""Labels turned round: a share of them, always the same ones, and nothing else of the answer."""

from __future__ import annotations

from pix2pred.predicates import Labeller, LabelSettings, ground_atoms
from pix2pred.vlm.noise.flips import FlippingVLM
from predicates.scripted import COOKED, POOL, ScriptedVLM, demo


def values(rate: float, seed: int) -> list[bool]:
    def answer(request: object) -> str:
        return "* cooked(patty1): True. Why.\n* cooked(patty2): Unknown. Why.\n* under(patty1, small_blue_cup): False."

    labeller = Labeller(FlippingVLM(ScriptedVLM(answer), rate, seed), LabelSettings(double_check=False))
    atoms = ground_atoms((COOKED, POOL[1].predicate), demo().objects)
    labels = labeller.demo(demo(actions=40), atoms)
    assert all(v == -1 for s in labels for a, v in s.values.items() if str(a) == "cooked0(p2)")
    return [s.values[a] == 1 for s in labels for a in atoms if str(a) == "cooked0(p1)"]


def test_about_the_asked_share_is_flipped_and_always_the_same_labels() -> None:
    assert all(values(0.0, 0)) and not any(values(0.999999, 0))
    flipped = values(0.3, 1).count(False)
    assert 5 <= flipped <= 20
    assert values(0.3, 1) == values(0.3, 1) != values(0.3, 2)
