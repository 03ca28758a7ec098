"""A cascade whose asker weighs probabilities: it tells what it leans to, and the asker asks about what it needs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pix2pred.execution.belief.perception import Believing
from pix2pred.predicates import Labeller, LabelSettings, StateLabels, StepToLabel, ground_atoms
from pix2pred.registry import _said
from pix2pred.structs import Action, Atom, Label, Skill, State, Task, Vocabulary, WhyAsked, WorldModel
from pix2pred.vlm.distilled.cascade import Cascade
from pix2pred.vlm.distilled.files import read_reader, write_reader
from pix2pred.vlm.distilled.model import Why
from pix2pred.vlm.distilled.reader import DistilledReader
from pix2pred.vlm.offline.prompt_format import asked_atoms
from pix2pred.vlm.request import Leaning, Purpose
from vlm.distilled.lamps import SETTINGS, drawn, taught
from vlm.distilled.test_reader import ABOVE, ATOMS, LAMP, LIT, MADE, OBJECTS, WARM, Large

LIT1 = Atom(LIT, (OBJECTS[0],))
BETWEEN = (184, 158, 56)
"""Neither bright nor dark."""


@pytest.fixture(scope="module")
def reader(tmp_path_factory: pytest.TempPathFactory) -> DistilledReader:
    folder: Path = tmp_path_factory.mktemp("readers") / "lamps"
    write_reader(folder, taught(), MADE, SETTINGS.model_dump())
    return DistilledReader(*read_reader(folder))


def between(reader: DistilledReader) -> tuple[State, Atom, float]:
    """A scene with a lamp of which the reader is not sure, the atom, and how probably it takes it to be lit."""
    for seed in range(60):
        look, _ = drawn(np.random.default_rng(seed), BETWEEN)
        for atom in ground_atoms((LIT,), OBJECTS):
            [reading] = reader._model.read(look, [("lit", (atom.objects[0].name,))])
            if reading.why == Why.UNSURE and abs(reading.probability - 0.5) + 0.5 > 0.6:
                return State(look.pictures), atom, reading.probability
    pytest.fail("the reader is sure of everything")


def first(model: Cascade, shown: State, atoms: list[Atom], *, structured: bool = False) -> StateLabels:
    return Labeller(model, LabelSettings(structured=structured)).first(shown, OBJECTS, atoms)


def test_what_it_is_not_sure_of_is_told_with_its_probability_and_not_asked(reader: DistilledReader) -> None:
    shown, atom, p = between(reader)
    large = Large({})
    asking = Cascade(reader, large, _said, 0.0)
    assert isinstance(asking, Leaning)
    first(asking, shown, [atom])
    assert [str(a) for a in asked_atoms(large.asked[0].text)] == [f"lit({atom.objects[0].name})"]
    said = first(asking.leaning(), shown, [atom])
    assert len(large.asked) == 1 and said.values[atom] == Label.of(p > 0.5)
    assert said.confidence[atom] == pytest.approx(max(p, 1 - p), abs=1e-3)
    assert len(asking.tally.by_reader) == 1  # both count together


@pytest.mark.parametrize("structured", [False, True])
def test_what_it_knows_nothing_of_is_asked_all_the_same(reader: DistilledReader, structured: bool) -> None:
    shown, atom, _ = between(reader)
    warm = Atom(WARM, (OBJECTS[1],))
    large = Large({"warm(lamp2)": False}, as_json=structured)
    said = first(Cascade(reader, large, _said, 0.0).leaning(), shown, [atom, warm], structured=structured)
    asked = {str(a) for a in asked_atoms(large.asked[0].text)}
    # in JSON there is no place for a probability: what is asked of in JSON is asked about as a whole
    assert asked == {"warm(lamp2)"} | ({f"lit({atom.objects[0].name})"} if structured else set())
    assert said.values[warm] == Label.FALSE and (atom in said.confidence) != structured


def test_what_it_leans_to_is_not_told_as_certain_beside_a_check_in_json(reader: DistilledReader) -> None:
    shown, atom, _ = between(reader)
    large = Large({}, as_json=True)
    said = first(Cascade(reader, large, _said, 1.0).leaning(), shown, [*ATOMS], structured=True)
    assert f"lit({atom.objects[0].name})" in {str(a) for a in asked_atoms(large.asked[0].text)}
    assert said.values[atom] == Label.TRUE and atom not in said.confidence  # as the large model says


def test_probabilities_of_the_large_model_are_not_taken_for_measured_ones(reader: DistilledReader) -> None:
    shown, atom, _ = between(reader)
    warm = Atom(WARM, (OBJECTS[1],))
    large = Large({}, sure=0.99)
    said = first(Cascade(reader, large, _said, 0.0), shown, [warm])
    assert said.confidence[warm] == pytest.approx(0.99)
    said = first(Cascade(reader, large, _said, 0.0).leaning(), shown, [atom, warm])
    assert said.values[warm] == Label.TRUE and set(said.confidence) == {atom}


def test_what_no_picture_shows_keeps_its_value_and_is_no_evidence(reader: DistilledReader) -> None:
    look, _ = drawn(np.random.default_rng(5))
    [picture] = look.pictures
    gone = State((replace(picture, boxes={n: b for n, b in picture.boxes.items() if n != "lamp1"}),))
    hide = Action(Skill("Hide", (LAMP,)), (OBJECTS[0],))
    large = Large({})
    labeller = Labeller(Cascade(reader, large, _said, 0.0).leaning(), LabelSettings())
    before = labeller.first(State(look.pictures), OBJECTS, ATOMS)
    step = StepToLabel(State(look.pictures), gone, 1, hide, before)
    after = labeller.next(step, OBJECTS, ATOMS)
    assert not large.asked and after.values[LIT1] == before.values[LIT1] != Label.UNKNOWN
    assert after.confidence[LIT1] == pytest.approx(0.5)


def test_a_belief_lets_it_lean_and_asks_the_large_model_about_what_it_needs(reader: DistilledReader) -> None:
    shown, atom, p = between(reader)
    lamp = atom.objects[0].name
    large = Large({f"lit({lamp})": p < 0.5})
    model = WorldModel(Vocabulary("lamps", (), (), ()), (LIT, ABOVE), (), "large:1")
    task = Task("dusk", tuple(OBJECTS), shown, (atom,))
    labeller = Labeller(Cascade(reader, large, _said, 0.0), LabelSettings())
    perception = Believing()(model, task, labeller)
    perception.start(shown)
    assert not large.asked and (perception.probability(atom) > 0.5) == (p > 0.5)
    before = perception.probability(atom)
    perception.ask([atom], WhyAsked.IN_DOUBT)
    assert {r.purpose for r in large.asked} == {Purpose.ASK_AGAIN}
    assert (perception.probability(atom) < before) == (p > 0.5)
