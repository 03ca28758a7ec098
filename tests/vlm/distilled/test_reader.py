"""Readers as files and as models: what they answer, what they refuse, and how they share work with a large model."""

from __future__ import annotations

import hashlib
import json
import threading
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

from pix2pred.images import ShownPictures
from pix2pred.predicates import Labeller, LabelSettings, StepToLabel, ground_atoms
from pix2pred.predicates.labelling.again import SecondLook
from pix2pred.registry import REGISTRY, _said
from pix2pred.structs import Action, Atom, FromVLM, Label, Object, Predicate, Skill, State, Type
from pix2pred.vlm import Answer, AnswerStore, NoAnswerError, Purpose, Request, VLMError
from pix2pred.vlm.distilled.cascade import Cascade
from pix2pred.vlm.distilled.files import (
    CARD,
    WEIGHTS,
    MadeFrom,
    ReaderFileError,
    read_reader,
    write_reader,
)
from pix2pred.vlm.distilled.reader import DistilledReader, Line, written
from pix2pred.vlm.distilled.tally import Checked, Tally
from pix2pred.vlm.mailbox import MailboxVLM
from pix2pred.vlm.mailbox_folder import MailboxFolder
from pix2pred.vlm.model_spec import ModelNameError
from pix2pred.vlm.offline.label_question import Look
from pix2pred.vlm.offline.prompt_format import asked_atoms, value_line
from vlm.distilled.lamps import BRIGHT, SETTINGS, TYPES, drawn, taught
from vlm.test_mailbox import AGES, awaited

LAMP, TRAY = Type("lamp"), Type("tray")
OBJECTS = [Object(name, LAMP if kind == "lamp" else TRAY) for name, kind in TYPES.items()]
LIT = Predicate("lit0", (LAMP,), FromVLM("lit"))
ABOVE = Predicate("above0", (LAMP, TRAY), FromVLM("above"))
WARM = Predicate("warm0", (LAMP,), FromVLM("warm"))
ATOMS = ground_atoms((LIT, ABOVE), OBJECTS)
MADE = MadeFrom(
    teacher="large:1", vocabulary="lamps", demonstrations=8, episodes=0, looks=40, labels=160, corrected=0, doubted=0,
    data="",
)  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("readers") / "lamps"
    write_reader(made, taught(), MADE, SETTINGS.model_dump())
    return made


@pytest.fixture
def reader(folder: Path) -> DistilledReader:
    return DistilledReader(*read_reader(folder))


def state(seed: int, bright: tuple[int, ...] = BRIGHT) -> tuple[State, dict[Atom, bool], Look]:
    look, truth = drawn(np.random.default_rng(seed), bright)
    values = {a: truth[(a.predicate.name.rstrip("0"), *(o.name for o in a.objects))] for a in ATOMS}
    return State(look.pictures), values, look


@dataclass
class Large:
    """A model that is right about what it is asked, in words or as JSON."""

    truth: dict[str, bool]
    as_json: bool = False
    name: str = "large:1"
    asked: list[Request] = field(default_factory=list)
    refuses: bool = False
    sure: float | None = None

    def answer(self, request: Request) -> Answer:
        self.asked.append(request)
        if self.refuses:
            raise NoAnswerError("the server is down")
        values = {str(a): self.truth.get(str(a), True) for a in asked_atoms(request.text)}
        if self.as_json:
            rows = [{"atom": a, "explanation": "so", "value": str(v)} for a, v in values.items()]
            return Answer("```json\n" + json.dumps({"values": rows}) + "\n```")
        if self.sure is not None:
            return written(
                request.text, [Line(value_line(a, True, "So."), "True", self.sure) for a in asked_atoms(request.text)]
            )
        return Answer("\n".join(f"* {atom}: {value}. As I see it." for atom, value in values.items()))


def cascade(reader: DistilledReader, large: Large, checked: float = 0.0) -> Cascade:
    return Cascade(reader, large, _said, checked)


def labels(model: object, shown: State, atoms: Sequence[Atom] = ATOMS, **settings: object) -> dict[Atom, Label]:
    labeller = Labeller(model, LabelSettings.model_validate(settings))  # type: ignore[arg-type]
    return labeller.first(shown, OBJECTS, atoms).values


def test_a_reader_read_back_says_what_it_said_and_equal_ones_have_equal_bytes(folder: Path, tmp_path: Path) -> None:
    write_reader(tmp_path, taught(), MADE, SETTINGS.model_dump())
    for name in (CARD, WEIGHTS):
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes()
    assert (folder / WEIGHTS).stat().st_size < 1_000_000
    model, card, digest = read_reader(folder)
    _, _, look = state(1)
    atoms = [("lit", ("lamp1",)), ("above", ("lamp2", "tray"))]
    again, first = model.read(look, atoms), taught().model.read(look, atoms)
    assert [r.value for r in again] == [r.value for r in first]
    assert card.made_from.teacher == "large:1" and DistilledReader(model, card, digest).name == f"reader:{digest[:12]}"


def test_a_reader_made_before_curves_were_averaged_is_read_by_its_likeliest_curve(folder: Path, tmp_path: Path) -> None:
    with np.load(folder / WEIGHTS) as stored:
        np.savez(tmp_path / WEIGHTS, **{name: stored[name] for name in stored.files if "|odds|" not in name})
    card = json.loads((folder / CARD).read_text())
    card["weights"] = hashlib.sha256((tmp_path / WEIGHTS).read_bytes()).hexdigest()
    (tmp_path / CARD).write_text(json.dumps(card))
    for kinds, words in read_reader(tmp_path)[0].kinds.items():
        for word, old in words.words.items():
            curve = old.calibration
            expected = 1 / (1 + np.exp(-curve.slope * (0.3 - curve.middle)))
            assert curve.probability(0.3) == pytest.approx(np.clip(expected, 1 - curve.most, curve.most))
            new = read_reader(folder)[0].kinds[kinds].words[word].calibration
            assert abs(new.probability(0.3) - 0.5) < abs(curve.probability(0.3) - 0.5)


def test_readers_that_cannot_be_used_are_refused_in_one_sentence(folder: Path, tmp_path: Path) -> None:
    card, weights = (folder / CARD).read_text(), (folder / WEIGHTS).read_bytes()
    hostile = {
        "holds no reader": ("", weights),
        "damaged": (card, weights[:-100]),
        "version 4": (card.replace('"version": 3', '"version": 4'), weights),
        "cannot be read": ("{", weights),
        "distil the reader again": (card.replace('"sure"', '"shure"'), weights),
    }
    for why, (text, content) in hostile.items():
        made = tmp_path / why.replace(" ", "-")
        made.mkdir()
        if text:
            (made / CARD).write_text(text)
        (made / WEIGHTS).write_bytes(content)
        with pytest.raises(ReaderFileError, match=why) as refused:
            read_reader(made)
        assert "\n" not in str(refused.value)


def test_labels_come_with_their_probabilities(reader: DistilledReader) -> None:
    shown, truth, _ = state(2)
    found = Labeller(reader, LabelSettings()).first(shown, OBJECTS, ATOMS)
    known = {a: v for a, v in found.values.items() if v != Label.UNKNOWN}
    assert known and all((v == Label.TRUE) == truth[a] for a, v in known.items())
    assert set(found.confidence) == set(known) and all(0.95 <= p <= 1 for p in found.confidence.values())


def test_neither_the_skill_nor_the_values_before_change_what_is_read(reader: DistilledReader) -> None:
    (before, _, _), (after, _, _) = state(3), state(4)
    labeller = Labeller(reader, LabelSettings())
    first = labeller.first(before, OBJECTS, ATOMS)
    seen = []
    for skill in ("SwitchOn", "Break"):
        for said in (first, replace(first, text=first.text.replace("False", "True"))):
            action = Action(Skill(skill, (LAMP,)), (OBJECTS[0],))
            step = StepToLabel(before, after, 1, action, said, double_check=True)
            seen.append(labeller.next(step, OBJECTS, ATOMS).values)
    assert all(values == seen[0] for values in seen)


def test_out_of_sight_keeps_its_value_and_asking_again_gives_no_second_opinion(reader: DistilledReader) -> None:
    before, _, _ = state(5)
    picture = before.pictures[0]
    gone = State((replace(picture, boxes={n: b for n, b in picture.boxes.items() if n != "lamp1"}),))
    labeller = Labeller(reader, LabelSettings())
    first = labeller.first(before, OBJECTS, ATOMS)
    step = StepToLabel(before, gone, 1, Action(Skill("Hide", (LAMP,)), (OBJECTS[0],)), first)
    after = labeller.next(step, OBJECTS, ATOMS)
    hidden = Atom(LIT, (OBJECTS[0],))
    assert after.confidence[hidden] == pytest.approx(0.5)  # nobody saw it: no evidence
    assert after.values[hidden] == first.values[hidden] != Label.UNKNOWN
    assert SecondLook(labeller).ask(before, 0, OBJECTS, hidden, 0) == Label.UNKNOWN


def test_it_answers_no_questions_but_those_about_labels(reader: DistilledReader) -> None:
    with pytest.raises(VLMError, match="reads labels"):
        reader.answer(Request(Purpose.PLAN, ("Plan.",), 10))
    text = reader.answer(Request(Purpose.PROPOSE, ("- lamp1 (lamp)\n- tray (tray)",), 10)).text
    assert "* lit(lamp1)" in text and "* above(lamp1, tray)" in text


def test_frugal_questions_about_histories_are_read_state_by_state(reader: DistilledReader) -> None:
    from pix2pred.predicates import labeller_for

    (before, then, _), (after, now, _) = state(3), state(4)
    labeller = labeller_for(reader, LabelSettings.model_validate({"protocol": "frugal"}))
    first = labeller.first(before, OBJECTS, ATOMS)
    step = StepToLabel(before, after, 1, Action(Skill("SwitchOn", (LAMP,)), (OBJECTS[0],)), first)
    last = labeller.next(step, OBJECTS, ATOMS)
    for found, truth in ((first.values, then), (last.values, now)):
        assert all((v == Label.TRUE) == truth[a] for a, v in found.items() if v != Label.UNKNOWN)
        assert sum(v != Label.UNKNOWN for v in found.values()) >= 3


@pytest.mark.parametrize("as_json", [False, True])
def test_a_cascade_asks_the_large_model_about_the_rest_alone(reader: DistilledReader, as_json: bool) -> None:
    shown, truth, _ = state(6)
    atoms = ground_atoms((LIT, ABOVE, WARM), OBJECTS)
    large = Large({"warm(lamp1)": False}, as_json)
    model = cascade(reader, large)
    found = labels(model, shown, atoms, structured=as_json)
    read = {a for a, v in labels(reader, shown).items() if v != Label.UNKNOWN}
    [request] = large.asked
    assert {str(a) for a in asked_atoms(request.text)} == {
        f"{a.predicate.name[:-1]}({', '.join(o.name for o in a.objects)})" for a in atoms if a not in read
    }
    assert ("warm(lamp1)" in request.schema and "lit(" not in request.schema) == as_json
    assert all((found[a] == Label.TRUE) == truth[a] for a in read) and len(read) >= 3
    assert found[Atom(WARM, (OBJECTS[0],))] == Label.FALSE and found[Atom(WARM, (OBJECTS[1],))] == Label.TRUE
    tally = model.tally
    assert (len(tally.by_reader), len(tally.by_model), len(tally.questions)) == (len(read), len(atoms) - len(read), 1)


def test_what_is_sure_is_not_asked_and_survives_a_model_that_does_not_answer(reader: DistilledReader) -> None:
    shown, _, _ = state(6)
    sure = [a for a, v in labels(reader, shown).items() if v != Label.UNKNOWN]
    large = Large({}, refuses=True)
    assert labels(cascade(reader, large), shown, sure) == {a: labels(reader, shown)[a] for a in sure}
    assert not large.asked
    found = labels(cascade(reader, large), shown, [*sure, Atom(WARM, (OBJECTS[0],))])
    assert large.asked and all(found[a] == labels(reader, shown)[a] for a in sure)


def test_a_share_of_sure_answers_is_checked_and_changes_nothing(reader: DistilledReader) -> None:
    shown, truth, _ = state(6)
    read = {a: v for a, v in labels(reader, shown).items() if v != Label.UNKNOWN}
    words = {a: f"{a.predicate.name[:-1]}({', '.join(o.name for o in a.objects)})" for a in read}
    liar = Large({words[a]: not truth[a] for a in read})
    model = cascade(reader, liar, checked=1.0)
    assert labels(model, shown, list(read)) == read
    said = model.tally.as_dict()
    assert {what: said[what] for what in ("by_reader", "by_model", "questions", "checked", "differed", "drifted")} == {
        "by_reader": len(read), "by_model": 0, "questions": 1, "checked": len(read), "differed": len(read),
        "drifted": True,
    }  # fmt: skip
    assert {word: count["differed"] for word, count in said["words"].items()} == Counter(
        a.predicate.name.rstrip("0") for a in read
    )
    assert {(row["atom"], row["read"]) for row in said["differences"]} == {(words[a], truth[a]) for a in read}
    assert {row["picture"] for row in said["differences"]} == {shown.pictures[0].image.digest}
    assert "distil again" in model.tally.line()
    labels(model, shown, list(read))
    assert len(liar.asked) == 1  # the same look is not checked again


def test_drift_is_more_than_chance() -> None:
    tally = Tally()
    tally.note("look", [], [], [Checked(f"a{i}", 0.02, True, i != 0) for i in range(50)], None)
    assert tally.chance > 0.5 and not tally.drifted
    tally.note("other", [], [], [Checked(f"a{i}", 0.02, True, i >= 8) for i in range(50)], None)
    assert tally.chance < 0.001 and tally.drifted and "drift" not in Tally().line()


def test_a_reader_writes_no_plans_and_a_cascade_does_what_its_model_does() -> None:
    writes = {
        spec: REGISTRY.writes(spec) for spec in ("offline", "reader:r", "cascade:r,openai:gpt-4o", "openai:gpt-4o")
    }
    assert writes == {"offline": False, "reader:r": False, "cascade:r,openai:gpt-4o": True, "openai:gpt-4o": True}
    assert not REGISTRY.writes("cascade:r,offline")


def test_readers_and_cascades_can_be_named_and_cost_nothing_or_less(folder: Path, tmp_path: Path) -> None:
    store = AnswerStore(tmp_path)
    shown, _, _ = state(7)
    free = REGISTRY.estimator(f"reader:{folder}", None, store)
    labels(free, shown)
    assert free.as_dict()["dollars"] == 0.0
    cheap = REGISTRY.estimator(f"cascade:{folder},openai:gpt-4o", None, store)
    labels(cheap, shown, ground_atoms((LIT, ABOVE, WARM), OBJECTS))
    assert 2 <= cheap.as_dict()["atoms"] <= 3 < len(ATOMS) + 2
    for wrong in ("cascade:here", "cascade:,openai:gpt-4o", f"cascade:{folder},nobody"):
        with pytest.raises(ModelNameError):
            REGISTRY.model_spec(wrong)
    with pytest.raises(ReaderFileError, match="pix2pred distil"):
        REGISTRY.vlm(f"reader:{tmp_path}", None)


def test_a_person_behind_a_reader_is_asked_about_the_rest_alone(reader: DistilledReader, tmp_path: Path) -> None:
    shown, truth, _ = state(6)
    warm = ground_atoms((WARM,), OBJECTS)
    model = Cascade(reader, MailboxVLM(tmp_path, ShownPictures(), poll=0.01), _said, 0.0)
    found: list[dict[Atom, Label]] = []
    sure = [a for a, v in labels(reader, shown).items() if v != Label.UNKNOWN]
    thread = threading.Thread(target=lambda: found.append(labels(model, shown, [*sure, *warm])), daemon=True)
    thread.start()
    form = awaited(tmp_path, "[!.]*/form.txt")
    assert form.read_text() == "* warm(lamp1): ?\n* warm(lamp2): ?\n"
    assert MailboxFolder(tmp_path).question(form.parent.name).states == (0,)
    form.write_text("* warm(lamp1): True\n* warm(lamp2): False\n")
    form.rename(form.with_name("answer.txt"))
    thread.join(AGES)
    assert found == [{a: Label.of(truth[a]) for a in sure} | dict(zip(warm, (Label.TRUE, Label.FALSE), strict=True))]
