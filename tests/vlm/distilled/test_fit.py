"""Distilled readers: right about what they answer, and aware of what they do not know."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import PIL.Image
import pytest

from pix2pred.registry import load_domain
from pix2pred.structs import Box, Image, Picture
from pix2pred.vlm.distilled.calibration import calibrate
from pix2pred.vlm.distilled.fitting.fit import fit
from pix2pred.vlm.distilled.fitting.lesson import Example, Lesson, LessonError
from pix2pred.vlm.distilled.fitting.naming import by_name
from pix2pred.vlm.distilled.fitting.rows import ShownObjects
from pix2pred.vlm.distilled.model import BY_NO_NAME, AtomReading, Why
from pix2pred.vlm.distilled.regions import COMPANION, RELATION, PictureSeen
from pix2pred.vlm.distilled.sight import NEAR_SIDE, ORIENTATIONS, Augmentation, PicturePyramid, see, split
from pix2pred.vlm.offline.label_question import Look
from vlm.distilled.lamps import BRIGHT, SETTINGS, TYPES, drawn, lesson, look_at, taught


def read(look: Look, *atoms: tuple[str, ...]) -> list[AtomReading]:
    return taught().model.read(look, [(word, tuple(names)) for word, *names in atoms])


def answers(seed: int, count: int, bright: tuple[int, ...] = BRIGHT) -> tuple[float, float]:
    """Of fresh looks the share of atoms that are answered, and of answers the share that is right."""
    rng = np.random.default_rng(seed)
    said = []
    for _ in range(count):
        look, truth = drawn(rng, bright)
        said += [(r.value, value) for r, value in zip(read(look, *truth), truth.values(), strict=True)]
    answered = [value == truth for value, truth in said if value is not None]
    return len(answered) / len(said), sum(answered) / max(1, len(answered))


def test_a_reader_is_right_about_fresh_looks_although_its_teacher_was_not_always() -> None:
    answered, right = answers(2, 60)
    assert answered >= 0.9 and right >= 0.98


def test_the_card_says_how_words_did_on_demonstrations_left_out() -> None:
    results = {result.word: result for result in taught().results}
    assert set(results) == {"lit", "above"}
    for result in results.values():
        assert result.seen == 80 and 20 < result.true < 60
        assert result.answered > 60 and 0.85 < result.right / result.answered < 1.0  # its teacher errs
        assert 0.0 < result.teacher_error < 0.12


def test_the_same_labels_give_the_same_reader_whatever_came_before() -> None:
    one, other = fit(lesson(5, 4, 4), SETTINGS), fit(lesson(5, 4, 4), SETTINGS)
    for kinds, model in one.model.kinds.items():
        assert np.array_equal(model.rows.codes, other.model.kinds[kinds].rows.codes)
        for word, word_taught in model.words.items():
            assert np.array_equal(word_taught.machine.weights, other.model.kinds[kinds].words[word].machine.weights)


def test_pixels_decide_and_boxes_alone_do_not() -> None:
    rng = np.random.default_rng(3)
    while True:
        look, truth = drawn(rng)
        if truth["lit", "lamp1"] != truth["lit", "lamp2"] and truth["above", "lamp1", "tray"]:
            break
    before = read(look, ("lit", "lamp1"), ("lit", "lamp2"))
    picture = look.pictures[0]
    pixels = picture.image.pixels().copy()
    one, other = (
        tuple(slice(int(a), int(b)) for a, b in ((box.top, box.bottom), (box.left, box.right)))
        for box in (picture.boxes["lamp1"], picture.boxes["lamp2"])
    )
    pixels[one], pixels[other] = pixels[other].copy(), pixels[one].copy()
    swapped = Look((replace(picture, image=Image.from_pixels(pixels)),), TYPES)
    after = read(swapped, ("lit", "lamp1"), ("lit", "lamp2"))
    assert [r.value for r in before] == [truth["lit", "lamp1"], truth["lit", "lamp2"]]
    assert [r.value for r in after] == [truth["lit", "lamp2"], truth["lit", "lamp1"]]


def test_it_does_not_know_what_it_cannot_see_or_was_not_taught() -> None:
    look, _ = drawn(np.random.default_rng(4))
    picture = look.pictures[0]
    pixels = picture.image.pixels().copy()
    box = picture.boxes["lamp1"]
    pixels[int(box.top) : int(box.bottom), int(box.left) : int(box.right)] = 128
    blank = Look((replace(picture, image=Image.from_pixels(pixels)),), TYPES)
    gone = Look((Picture("front", picture.image, {n: b for n, b in picture.boxes.items() if n != "lamp1"}),), TYPES)
    assert [r.why for r in read(blank, ("lit", "lamp1"), ("above", "lamp1", "tray"))] == [Why.BLANK, Why.BLANK]
    assert read(gone, ("lit", "lamp1"))[0] == AtomReading(None, 0.5, Why.UNSEEN)
    assert [r.why for r in read(look, ("warm", "lamp1"), ("lit", "tray"))] == [Why.UNTAUGHT, Why.UNTAUGHT]


def test_another_look_of_things_lowers_coverage_before_accuracy() -> None:
    usual, _ = answers(6, 25)
    violet, right = answers(6, 25, (200, 40, 255))
    assert violet < usual - 0.2 and right >= 0.95


def test_another_world_under_the_same_names_is_strange() -> None:
    rng = np.random.default_rng(7)
    readings = []
    for _ in range(10):
        look, truth = drawn(rng)
        pixels = rng.integers(0, 255, (96, 96, 3)).astype(np.uint8)
        other = Look((replace(look.pictures[0], image=Image.from_pixels(pixels)),), TYPES)
        readings += read(other, *truth)
    assert sum(r.value is None for r in readings) >= 0.95 * len(readings)
    assert {r.why for r in readings} >= {Why.STRANGE}


def test_objects_of_another_domain_under_the_same_names_are_strange() -> None:
    task = load_domain("burger").tasks("combo", 5, 1)[0].task
    picture = task.initial.pictures[0]
    names = sorted(picture.boxes)
    readings: list[AtomReading] = []
    for one, other in pairwise([*names, names[0]]):
        boxes = {"lamp1": picture.boxes[one], "tray": picture.boxes[other]}
        look = Look((replace(picture, boxes=boxes),), TYPES)
        readings += read(look, ("lit", "lamp1"), ("above", "lamp1", "tray"))
    assert len(readings) >= 20 and sum(r.value is None for r in readings) >= 0.95 * len(readings)


def test_what_is_usual_does_not_shrink_as_demonstrations_repeat_one_another() -> None:
    few = lesson(1)
    again = [f"again {group}" for group in few.groups]
    repeated = [replace(e, look=e.look + len(few.looks)) for e in few.examples]
    twice = Lesson([*few.looks, *few.looks], [*few.groups, *again], [*few.examples, *repeated])
    once, repeating = fit(few, SETTINGS).model, fit(twice, SETTINGS).model
    for kinds, model in once.kinds.items():
        assert repeating.kinds[kinds].nearest >= 0.5 * model.nearest
    rng = np.random.default_rng(2)
    for _ in range(20):
        look, truth = drawn(rng)
        atoms = [(word, tuple(names)) for word, *names in truth]
        assert Why.STRANGE not in {r.why for r in repeating.read(look, atoms)}


def test_a_place_that_was_never_seen_makes_all_in_it_strange() -> None:
    rng = np.random.default_rng(3)
    for _ in range(10):
        look, truth = drawn(rng)
        [picture] = look.pictures
        pixels = picture.image.pixels().copy()
        elsewhere = np.ones(pixels.shape[:2], dtype=bool)
        for box in picture.boxes.values():  # the things themselves, and what is about them, are as ever
            top, bottom, left, right = (
                round(v) for v in (box.top - 14, box.bottom + 14, box.left - 14, box.right + 14)
            )
            elsewhere[max(0, top) : bottom, max(0, left) : right] = False
        pixels[elsewhere] = (20, 60, 10)
        moved = Look((replace(picture, image=Image.from_pixels(pixels)),), TYPES)
        atoms = [(word, *names) for word, *names in truth]
        assert {r.why for r in read(moved, *atoms)} == {Why.STRANGE}
        assert Why.STRANGE not in {r.why for r in read(look, *atoms)}


def test_a_camera_that_shows_none_of_the_things_is_not_even_unpacked() -> None:
    look, truth = drawn(np.random.default_rng(4))
    torn = Picture("back", Image(b"torn"), {})
    atoms = [(word, *names) for word, *names in truth]
    assert read(replace(look, pictures=(*look.pictures, torn)), *atoms) == read(look, *atoms)


def test_names_tell_what_never_changes_and_nothing_else() -> None:
    found = lesson(11, groups=14, each=4, wrong=0.03)
    heavy = [
        Example(i, "heavy", (name,), name == "lamp1") for i in range(len(found.looks)) for name in ("lamp1", "lamp2")
    ]
    lied = [replace(e, label=not e.label) if i == 7 else e for i, e in enumerate(heavy)]
    model = fit(Lesson(found.looks, found.groups, [*found.examples, *lied]), SETTINGS).model
    words = model.kinds["lamp",].words
    assert words["heavy"].by_name.values == {"lamp1": True, "lamp2": False}
    assert words["heavy"].by_name.probability > 0.9 and words["lit"].by_name == BY_NO_NAME
    assert all(word.by_name == BY_NO_NAME for word in model.kinds["lamp", "tray"].words.values())
    look, _ = drawn(np.random.default_rng(12))
    atoms = [("heavy", ("lamp1",)), ("heavy", ("lamp2",))]
    assert [r.value for r in model.read(look, atoms)] == [True, False]
    seen = words["heavy"].calibration.probability(0.0)
    assert words["heavy"].probability(0.0, ("lamp3",)) == seen  # a name of which nothing is known says nothing
    assert words["heavy"].probability(0.0, ("lamp2",)) < seen < words["heavy"].probability(0.0, ("lamp1",))


def test_what_differs_from_demonstration_to_demonstration_is_not_told_by_names() -> None:
    labels = {ShownObjects(i, 0, (name,)): ((i // 3 + len(name)) % 2 == 0, 1.0) for i in range(60) for name in "ab"}
    assert by_name([str(i // 3) for i in range(60)], labels, 0.85) == BY_NO_NAME
    steady = {row: (row.names == ("a",), weight) for row, (_, weight) in labels.items()}
    told = by_name([str(i // 3) for i in range(60)], steady, 0.85)
    habit = {row: (False, weight) for row, (_, weight) in labels.items()}
    assert by_name([str(i // 3) for i in range(60)], habit, 0.85) == BY_NO_NAME
    assert told.values == {"a": True, "b": False} and told.odds(("a",)) > 3 and told.odds(("c",)) == 0


def without(found: Lesson, word: str) -> Lesson:
    return Lesson(found.looks, found.groups, [e for e in found.examples if e.word != word])


def constant(found: Lesson) -> Lesson:
    return Lesson(found.looks, found.groups, [replace(e, label=True) for e in found.examples])


def test_lessons_that_teach_nothing_are_refused_in_one_sentence() -> None:
    small = lesson(8, 3, 3)
    one = Lesson(small.looks, ["demo"] * len(small.looks), small.examples)
    for hostile, why in (
        (one, "1 demonstration cannot teach"),
        (constant(small), "is labelled True always"),
        (Lesson(small.looks, small.groups, []), "nothing can be learned"),
    ):
        with pytest.raises(LessonError, match=why) as refused:
            fit(hostile, SETTINGS)
        assert "\n" not in str(refused.value)


def test_a_word_that_never_changes_is_named_and_the_others_are_taught() -> None:
    small = lesson(8, 4, 4)
    examples = [replace(e, label=False) if e.word == "above" else e for e in small.examples]
    fitted = fit(Lesson(small.looks, small.groups, examples), SETTINGS)
    assert {r.word for r in fitted.results} == {"lit"}
    assert [(u.word, u.reason.partition(",")[0]) for u in fitted.untaught] == [("above", "is labelled False always")]


def test_whole_pictures_teach_about_objects_by_name_where_nothing_has_a_box() -> None:
    boxed = without(lesson(9, 6, 6), "above")
    bare = [Look(tuple(replace(p, boxes={}) for p in look.pictures), look.types) for look in boxed.looks]
    fitted = fit(Lesson(bare, boxed.groups, boxed.examples), SETTINGS)
    assert {kinds for _, kinds in fitted.model.words} == {("@lamp1",), ("@lamp2",)}
    assert fitted.model.read(bare[0], [("lit", ("lamp3",))])[0].why == Why.UNTAUGHT


def test_calibration_finds_out_how_often_the_teacher_errs() -> None:
    rng = np.random.default_rng(0)
    truth = rng.random(600) < 0.5
    scores = np.where(truth, 1.0, -1.0) + rng.normal(0, 0.3, 600)
    for rate in (0.0, 0.05):
        labels = truth ^ (rng.random(600) < rate)
        curve = calibrate(scores, labels, np.ones(600)).curve
        assert abs(curve.error - rate) <= 0.02
        assert curve.probability(1.0) > 0.99 and curve.probability(-1.0) < 0.01


def test_few_labels_leave_a_reader_less_sure_between_what_it_has_seen() -> None:
    scores = np.tile([-1.0, -0.6, 0.6, 1.0], 3)
    few = calibrate(scores, scores > 0, np.ones(len(scores))).curve
    many = calibrate(np.tile(scores, 50), np.tile(scores > 0, 50), np.ones(50 * len(scores))).curve
    likeliest = 1 / (1 + np.exp(-few.slope * (0.5 - few.middle)))
    assert 0.5 < few.probability(0.5) < min(likeliest, many.probability(0.5))


def test_gradients_are_counted_in_the_eighth_of_a_turn_to_which_they_point() -> None:
    for number, turn in enumerate((np.arange(ORIENTATIONS) + 0.3) * 2 * np.pi / ORIENTATIONS):
        down, across = np.mgrid[:NEAR_SIDE, :NEAR_SIDE] / (2.0 * NEAR_SIDE)
        grey = 0.5 + 0.4 * (np.cos(turn) * across + np.sin(turn) * down)
        pixels = np.repeat((255 * grey).astype(np.float32)[..., None], 3, axis=2)
        shown = PicturePyramid([PIL.Image.fromarray(np.clip(pixels, 0, 255).astype(np.uint8)).resize((640, 640))])
        counted = split(see(shown, [Box(0, 0, 640, 640)], [Augmentation(scale=0.8)]))["edges"].reshape(-1, ORIENTATIONS)
        assert counted.sum(axis=0).argmax() == number


def test_what_lies_about_an_object_is_told_by_type() -> None:
    rng = np.random.default_rng(0)
    places = {"tray": (40, 40), "lamp1": (50, 24), "lamp2": (4, 70)}
    look = look_at({"lamp1": True, "lamp2": True}, places, rng)
    found = PictureSeen(look, look.pictures[0]).relation(("tray",), ("lamp", "cup")).reshape(2, COMPANION)
    beside = PictureSeen(look, look.pictures[0]).relation(("tray", "lamp1"), ("lamp",))
    assert found[0, :RELATION].tolist() == beside.tolist(), "the lamp that shares most with the tray is told about"
    assert found[0, RELATION] == 1 and found[1].tolist() == [0] * COMPANION


def test_a_word_about_all_that_is_near_an_object_is_learned() -> None:
    looks = [drawn(np.random.default_rng(i)) for i in range(60)]
    bare = [not any(value for (word, *_), value in truth.items() if word == "above") for _, truth in looks]
    taught = [Example(i, "bare", ("tray",), value) for i, value in enumerate(bare[:40])]
    groups = [f"demo {i // 5}" for i in range(40)]
    model = fit(Lesson([look for look, _ in looks[:40]], groups, taught), SETTINGS).model
    said = [model.read(look, [("bare", ("tray",))])[0].value for look, _ in looks[40:]]
    answers = [(one, truth) for one, truth in zip(said, bare[40:], strict=True) if one is not None]
    assert len(answers) >= 16 and sum(one == truth for one, truth in answers) >= len(answers) - 1
