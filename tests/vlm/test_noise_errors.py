"""Errors on purpose: which labels are turned round, and when the error is repeated."""

from __future__ import annotations

import numpy as np
import pytest

from pix2pred.structs import Image, Picture
from pix2pred.structs.views import View
from pix2pred.vlm import Answer, Request
from pix2pred.vlm.noise.errors import ErringVLM, Errors, Hidden, PerPicture, PerQuestion, Systematic, UntilTouched
from pix2pred.vlm.request import Purpose

ATOMS = [f"cooked(patty{i})" for i in range(200)]


class Honest:
    name = "honest"

    def answer(self, request: Request) -> Answer:
        return Answer("\n".join(f"* {atom}: True. So it is." for atom in ATOMS))


def request(shade: int, state: int = 0, words: str = "Which hold?") -> Request:
    picture = Picture("main", Image.from_pixels(np.full((4, 4, 3), shade, np.uint8)))
    return Request(Purpose.LABEL, (words, View(picture, state)), 100)


def wrong(errors: Errors, asked: Request, word: str = "False") -> set[str]:
    answer = ErringVLM(Honest(), errors).answer(asked).text
    return {atom for atom in ATOMS if f"* {atom}: {word}." in answer}


def test_independent_errors_differ_from_question_to_question() -> None:
    errors = PerQuestion(0.2, 1)
    first, again = wrong(errors, request(1)), wrong(errors, request(1, words="Which hold, pray?"))
    assert 20 < len(first) < 60 and first != again
    assert first == wrong(errors, request(1)), "the same question has the same answer"


def test_errors_of_a_picture_are_repeated_there_and_nowhere_else() -> None:
    errors = PerPicture(0.2, 1)
    first = wrong(errors, request(1))
    assert 20 < len(first) < 60
    assert first == wrong(errors, request(1, words="Which hold, pray?")) != wrong(errors, request(2, state=1))


def test_errors_of_an_object_last_until_a_skill_touches_it() -> None:
    errors = UntilTouched(0.2, 1)
    first = wrong(errors, request(1))
    names = ", ".join(f"patty{i}:patty" for i in range(100))
    later = wrong(errors, request(2, state=1, words=f"Executed skill: Cook[{names}]"))
    touched = {f"cooked(patty{i})" for i in range(100)}
    assert first - touched == later - touched != set()
    assert first & touched != later & touched


def test_systematic_errors_are_of_one_word_and_kind() -> None:
    assert wrong(Systematic(1.0, 1, "cooked", "patty7"), request(1)) == {
        a for a in ATOMS if a.startswith("cooked(patty7")
    }
    assert wrong(Systematic(1.0, 1, "chopped", "patty7"), request(1)) == set()


def test_hidden_values_are_unknown() -> None:
    assert 20 < len(wrong(Hidden(0.2, 1), request(1), "Unknown")) < 60
    assert wrong(Hidden(0.2, 1), request(1)) == set()


@pytest.mark.parametrize("errors", [PerQuestion(0.0, 1), PerPicture(0.0, 1), UntilTouched(0.0, 1), Hidden(0.0, 1)])
def test_rate_zero_changes_nothing_and_proposals_are_kept(errors: Errors) -> None:
    assert wrong(errors, request(1)) == set()
    proposal = Request(Purpose.PROPOSE, ("What?", *request(1).views), 100)
    always = ErringVLM(Honest(), PerPicture(1.0, 1))
    assert always.answer(proposal).text == Honest().answer(proposal).text
    assert errors.name.split(":")[0] in ErringVLM(Honest(), errors).name
