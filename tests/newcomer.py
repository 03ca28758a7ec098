"""A person with five photos: what they show, and answers as somebody gives who looks at them.

The scene is that of the method's authors' tea photos: a hand puts a tea bag and then two pieces of ice from a plate
into a glass of water. The pictures are drawn; the labels were written down while looking at the five photos.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import PIL.Image
import PIL.ImageDraw

from pix2pred.vlm import Answer, Request

ACTIONS = ("Pick(hand, teabag)", "PlaceIn(hand, teabag, glass)", "Pick(hand, ice)", "PlaceIn(hand, ice, glass)")
GOAL = ("In(teabag, glass)", "In(ice, glass)")
DECLARED = (
    *("--type", "hand", "--type", "item", "--type", "teabag:item", "--type", "ice:item", "--type", "glass"),
    *("--type", "plate", "--object", "hand:hand", "--object", "teabag:teabag", "--object", "glass:glass"),
    *("--object", "ice:ice = two pieces of ice", "--object", "plate:plate"),
    *("--skill", "Pick(hand, item)", "--skill", "PlaceIn(hand, item, glass)"),
    *("--predicate", "In(item, glass) = vlm: in"),
)
SEEN: Mapping[str, str] = {  # in states 0 to 4: true (1), false (0), not to be seen (?): the last photo shows no hand
    "holding(hand, teabag)": "01000",
    "holding(hand, two_pieces_of_ice)": "00010",
    "on(teabag, plate)": "10000",
    "on(two_pieces_of_ice, plate)": "11100",
    "in(teabag, glass)": "00111",
    "in(two_pieces_of_ice, glass)": "00001",
    "empty(hand)": "1010?",
    "brown(glass)": "00111",
}
WORDS = {"1": "True", "0": "False", "?": "Unknown"}


@dataclass
class Person:
    """Answers every question by looking at the picture of the state; ``unseen`` says what a new scene shows."""

    unseen: frozenset[str] = frozenset()
    name: str = "a person"
    questions: list[str] = field(default_factory=list)

    def answer(self, request: Request) -> Answer:
        self.questions.append(request.about)
        if request.purpose == "propose":
            return Answer("\n".join(atom for atom in SEEN if not atom.startswith("in(")))
        state = re.fullmatch(r"tea, state (\d)", request.about)
        atoms = re.findall(r"^\*? ?(\w+\([\w, ]*\))", request.text.rpartition("Predicates:")[2], re.MULTILINE)

        def value(atom: str) -> str:
            return WORDS[SEEN[atom][int(state[1])]] if state else str(atom in self.unseen)

        return Answer("\n".join(f"* {atom}: {value(atom)}." for atom in atoms))


def draw(folder: Path) -> Path:
    """The five photos, drawn."""
    folder.mkdir(parents=True)
    for t in range(5):
        picture = PIL.Image.fromarray(np.full((240, 320, 3), (205, 160, 110), np.uint8))
        pen = PIL.ImageDraw.Draw(picture)
        pen.ellipse((180, 120, 310, 220), fill="ivory", outline="gray")
        pen.rectangle((40, 60, 110, 140), fill="peru" if t >= 2 else "azure", outline="gray")
        hand = (20, 150, 100, 210) if t < 4 else (-80, 150, -10, 210)
        pen.rectangle(hand, fill="bisque")
        bag = [(240, 160), (60, 175), (75, 100)][min(t, 2)]
        pen.rectangle((*bag, bag[0] + 25, bag[1] + 25), fill="darkslategray")
        ice = (200, 140) if t < 3 else (60, 170) if t == 3 else (60, 70)
        pen.rectangle((*ice, ice[0] + 20, ice[1] + 15), fill="white")
        picture.save(folder / f"{t}.jpg")
    return folder


def fill_in(demo: Path) -> None:
    """Write the goal and the actions where ``demo.yaml`` says TODO."""
    text = demo.read_text()
    text = text.replace("goal:\n- TODO", "goal:\n" + "\n".join(f'- "{atom}"' for atom in GOAL))
    for action in ACTIONS:
        text = text.replace("- TODO", f'- "{action}"', 1)
    demo.write_text(text)
