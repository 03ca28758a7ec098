"""The offline readers of Cleanup and Juice: honest, and right about the words they claim to read (design 4.3)."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import train_reader
from extras import need
from pix2pred.domains.cleanup import CleanupDomain
from pix2pred.domains.home.cameras import pictures
from pix2pred.domains.home.domain import HomeDomain
from pix2pred.domains.juice import JuiceDomain
from pix2pred.predicates import Labeller, LabelSettings, ground_atoms
from pix2pred.predicates.labelling.state_labels import StepToLabel
from pix2pred.structs import Action, Atom, FromVLM, Image, Object, Picture, Predicate, State
from pix2pred.vlm.offline.model import WEIGHTS, ReaderModel
from pix2pred.vlm.offline.reader import OfflineReader

TEST_SEED = 7003
LEAST_MEAN = {"cleanup": 0.9, "juice": 0.97}
"""Balanced accuracy that a reader's words have on the mean."""
DOMAINS = {"cleanup": CleanupDomain(), "juice": JuiceDomain()}
ASIDE = {"cleanup": "wide_bin", "juice": "bowl"}
"""An object that is seen in the pair of states but neither moves nor changes."""

pytestmark = [
    need("mujoco", extra="sim"),
    pytest.mark.usefixtures("drawing"),
    pytest.mark.parametrize("name", list(DOMAINS)),
]


@cache
def model(name: str) -> ReaderModel:
    return ReaderModel.load(DOMAINS[name].reader or Path())


@cache
def pair(name: str) -> tuple[Sequence[Object], State, State, Action]:
    """Two states of a demonstration between which something visible happens."""
    domain: HomeDomain = DOMAINS[name]
    index, last = (0, 4) if name == "cleanup" else (7, 2)
    (start,) = [s for i, s in enumerate(domain.demonstration_starts("new-objects", TEST_SEED)) if i == index]
    environment = domain.environment(start.task, start.simulator)
    actions = domain.actions_of(domain.recipes[index], environment.world)
    for action in actions[: last - 1]:
        environment.execute(action)
    before = environment.observe()
    environment.execute(actions[last - 1])
    return start.task.objects, before, environment.observe(), actions[last - 1]


def all_atoms(name: str, objects: Sequence[Object]) -> list[Atom]:
    types = {o.type.name: o.type for o in objects}
    uses = model(name).words.uses()
    known = [(w.word, ts) for w, ts in uses if all(t in types for t in ts)]
    predicates = [
        Predicate(f"{word}{i}", tuple(types[t] for t in ts), FromVLM(word)) for i, (word, ts) in enumerate(known)
    ]
    return list(ground_atoms(predicates, objects))


def label(name: str, state: State, objects: Sequence[Object]) -> dict[Atom, int]:
    labeller = Labeller(OfflineReader(name, model(name)), LabelSettings())
    return dict(labeller.first(state, objects, all_atoms(name, objects)).values)


def test_the_card_is_about_these_weights_which_hold_numbers_alone(name: str) -> None:
    folder = DOMAINS[name].reader or Path()
    with np.load(folder / WEIGHTS, allow_pickle=False) as arrays:
        assert all(arrays[key].dtype.kind == "f" for key in arrays.files)
    card = json.loads((folder / "card.json").read_text())
    assert card["digest"] == model(name).digest
    assert (folder / WEIGHTS).stat().st_size < 1_500_000


def test_words_are_read_on_pictures_used_for_nothing_else(name: str) -> None:
    worlds, scenes = train_reader.read_worlds(name, TEST_SEED, 6, 3, 1)
    measured = train_reader.measure(name, model(name), worlds, scenes)
    accuracy = [word["balanced_accuracy"] for word in measured.values()]
    assert np.mean(accuracy) > LEAST_MEAN[name]
    assert all(word["hidden_unknown_share"] == 1.0 for word in measured.values())


def test_swapping_the_pixels_of_states_with_equal_boxes_swaps_the_labels(name: str) -> None:
    world = DOMAINS[name].demonstration_world(TEST_SEED, 0)
    changed = {"cleanup": ("desk", {"strokes": ()}), "juice": ("juicer", {"powered": False})}[name]
    other = world.with_thing(replace(world.thing(changed[0]), **changed[1]))  # type: ignore[arg-type]
    (first,), (second,) = pictures(world), pictures(other)
    assert first.boxes == second.boxes
    objects = DOMAINS[name].rules.objects(world)
    swapped = Picture("head", second.image, first.boxes), Picture("head", first.image, second.boxes)
    labels = [label(name, State((p,)), objects) for p in (first, second, *swapped)]
    assert labels[0] == labels[3] and labels[1] == labels[2] and labels[0] != labels[1]


def test_the_action_text_and_the_previous_answer_change_no_label_of_a_boxed_object(name: str) -> None:
    objects, before, after, _ = pair(name)
    seen = set(after.pictures[0].boxes)
    atoms = [a for a in all_atoms(name, objects) if {o.name for o in a.objects} <= seen]
    labeller = Labeller(OfflineReader(name, model(name)), LabelSettings())
    first = labeller.first(before, objects, atoms)
    text = first.text.replace("True", "FALSE").replace("False", "True").replace("FALSE", "False")
    found = []
    for previous in (first, replace(first, text=text)):
        for skill in DOMAINS[name].rules.skills.values():
            fitting = [next((o for o in objects if o.type.is_a(t)), None) for t in skill.types]
            if None in fitting:
                continue
            other = Action(skill, tuple(o for o in fitting if o is not None))
            step = StepToLabel(before, after, 1, other, previous, double_check=True)
            found.append(labeller.next(step, objects, atoms).values)
    assert all(values == found[0] for values in found)


def test_what_no_camera_shows_is_unknown_and_what_one_shows_is_not(name: str) -> None:
    objects, before, _, _ = pair(name)
    picture, aside = before.pictures[0], ASIDE[name]
    without = Picture("other", picture.image, {n: b for n, b in picture.boxes.items() if n != aside})
    hidden = label(name, State((without,)), objects)
    about = {a for a in hidden if aside in {o.name for o in a.objects}}
    assert about and {hidden[a] for a in about} == {-1}
    both = label(name, State((without, picture)), objects)
    alone = label(name, State((picture,)), objects)
    assert {a: both[a] for a in about} == {a: alone[a] for a in about}


def test_a_blanked_box_gives_unknown(name: str) -> None:
    objects, before, _, _ = pair(name)
    picture, aside = before.pictures[0], ASIDE[name]
    box, pixels = picture.boxes[aside], picture.image.pixels().copy()
    pixels[int(box.top) : int(box.bottom), int(box.left) : int(box.right)] = 128
    labels = label(name, State((Picture("head", Image.from_pixels(pixels), picture.boxes),)), objects)
    assert {v for a, v in labels.items() if aside in {o.name for o in a.objects}} == {-1}
