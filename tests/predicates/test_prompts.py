"""The prompts, word for word: a change of a prompt or of how it is filled shows here as a difference.

After an intended change run ``PIX2PRED_SNAPSHOTS=write pytest tests/predicates/test_prompts.py`` and read the diff.
"""

from __future__ import annotations

import os
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import pytest

from pix2pred.predicates import Labeller, LabelProtocol, LabelSettings, ProposalSettings, ground_atoms, labeller_for
from pix2pred.predicates.frugal.proposing import words_request
from pix2pred.predicates.labelling.again import SecondLook
from pix2pred.predicates.proposing.propose import proposal_request
from pix2pred.structs import FromVLM, Label, Predicate
from pix2pred.vlm import Request
from predicates.scripted import COOKED, HOLDING, POOL, ScriptedVLM, demo

SNAPSHOTS = Path(__file__).parents[1] / "data" / "prompts"
PROMPTS = files("pix2pred.predicates") / "prompts"
FILES = (
    "double_check",
    "frugal_label",
    "frugal_propose",
    "label_again",
    "label_against",
    "label_first",
    "label_first_terse",
    "label_next",
    "propose",
    "propose_specific",
)


def check(name: str, text: str) -> None:
    path = SNAPSHOTS / f"{name}.txt"
    if os.environ.get("PIX2PRED_SNAPSHOTS") == "write":
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    assert text.splitlines() == path.read_text(encoding="utf-8").splitlines()


def test_every_prompt_is_checked() -> None:
    assert sorted(p.name for p in PROMPTS.iterdir()) == sorted(f"{name}.txt" for name in FILES)


@pytest.mark.parametrize("name", FILES)
def test_prompt_file(name: str) -> None:
    check(name, (PROMPTS / f"{name}.txt").read_text(encoding="utf-8"))


def shown(request: Request) -> str:
    """Text and headings in the order they are sent."""
    parts = [p if isinstance(p, str) else f"[picture: {p.heading}]" for p in request.parts]
    return f"purpose {request.purpose}, at most {request.max_tokens} tokens\n\n" + "\n".join(parts) + "\n"


def labelling(settings: LabelSettings) -> list[Request]:
    vlm = ScriptedVLM(lambda request: f"* cooked(patty1): True. Answer {len(vlm.asked)} costs $5 {{and}} ${{more}}.")
    asked = Predicate("Holding", HOLDING.types, FromVLM("holding"))
    Labeller(vlm, settings).demo(demo(actions=1), ground_atoms((asked, COOKED, POOL[1].predicate), demo().objects))
    return vlm.asked


def test_filled_proposals() -> None:
    check("filled_propose", shown(proposal_request(demo(), ProposalSettings(max_atoms=25))))
    check("filled_propose_specific", shown(proposal_request(demo(), ProposalSettings(variant="specific"))))


def test_filled_labels() -> None:
    first, later, again = labelling(LabelSettings(attempts=1, hints=("Cooking is instantaneous.",)))
    check("filled_label_first", shown(first))
    check("filled_label_next", shown(later))
    check("filled_double_check", shown(again))
    check("filled_label_first_terse", shown(labelling(LabelSettings(attempts=1, style="terse"))[0]))


def test_filled_frugal_prompts() -> None:
    asked = Predicate(
        "holding0", HOLDING.types, FromVLM("holding", ("grasping",)), "The first has the second in its hand."
    )
    known = [replace(COOKED, description="The patty is brown."), asked]
    check("filled_frugal_propose", shown(words_request(demo(), known, ProposalSettings(max_atoms=25))))
    vlm = ScriptedVLM(lambda request: "* cooked(patty1): True\n* cooked(patty2): True")
    settings = LabelSettings(protocol=LabelProtocol.FRUGAL, attempts=1, hints=("Cooking is instantaneous.",))
    labeller = labeller_for(vlm, settings)
    labeller.demo(demo(actions=1), ground_atoms(known, demo().objects))
    labeller.first(demo().states[0], demo().objects, ground_atoms(known, demo().objects))
    check("filled_frugal_label", shown(vlm.asked[0]))
    check("filled_frugal_label_first", shown(vlm.asked[1]))


def test_filled_second_looks() -> None:
    vlm = ScriptedVLM(lambda request: "* cooked(patty1): True. It is brown.")
    atom = ground_atoms((COOKED,), demo().objects)[0]
    looking = SecondLook(Labeller(vlm, LabelSettings()))
    answers = [looking.ask(demo().states[0], 0, demo().objects, atom, number) for number in range(3)]
    check("filled_label_again", shown(vlm.asked[0]))
    check("filled_label_against", shown(vlm.asked[1]))
    looking.ask(
        demo().states[0], 0, demo().objects, replace(atom, predicate=replace(COOKED, description="It is brown.")), 0
    )
    check("filled_label_again_with_meaning", shown(vlm.asked.pop()))
    assert answers == [Label.TRUE] * 3
    assert [r.sample for r in vlm.asked] == [0, 0, 1], "a wording that is used again is another sample"
    assert len({r.key("m") for r in vlm.asked}) == 3
