"""What never changes of an object, by its name: an eraser is one in every look, whatever it is seen from.

Only a word that keeps its value while an episode lasts, that tells one name from another, and that the same name
foretold in other demonstrations, is learned so. What changes is read from pixels alone, however often a thing of that
name was so.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

from pix2pred.vlm.distilled.fitting.rows import ShownObjects
from pix2pred.vlm.distilled.model import BY_NO_NAME, ByName

STAYS = 0.95
"""The least probability that an atom has the same value in two looks of one demonstration, of words that do not change.
Chosen on seed 11 of Cleanup and Juice and seed 3 of Cleanup: words that do not change have 0.96 or more, others 0.94 or
less."""

_Course = tuple[str, str]
"""A demonstration or episode, and the name of an object in it."""


def by_name(groups: Sequence[str], labels: Mapping[ShownObjects, tuple[bool, float]], sure: float) -> ByName:
    """What names tell about a word, where they tell it with probability ``sure``; else nothing.

    ``labels`` are those of the word with their weights, ``groups`` the demonstration of each look.
    """
    courses: defaultdict[_Course, dict[int, tuple[bool, float]]] = defaultdict(dict)
    for row, label in labels.items():
        if len(row.names) != 1:
            return BY_NO_NAME
        courses[groups[row.look], row.names[0]][row.look] = label
    true = {course: _true(looks) for course, looks in courses.items()}
    long = [2 * p * (1 - p) for course, p in true.items() if len(courses[course]) > 1]
    if (len(long) - sum(long) + 1) / (len(long) + 2) < STAYS:  # Laplace's rule: few courses show little
        return BY_NO_NAME
    said: defaultdict[str, list[bool]] = defaultdict(list)
    for (_, name), p in true.items():
        said[name].append(p > 0.5)
    right = [
        ((sum(values) - own) * 2 > len(values) - 1) == own  # what the other demonstrations say
        for values in said.values()
        if len(values) > 1
        for own in values
    ]
    probability = (sum(right) + 1) / (len(right) + 2)
    values = {name: sum(held) * 2 > len(held) for name, held in sorted(said.items()) if len(held) > 1}
    if probability < sure or len(set(values.values())) < 2:
        return BY_NO_NAME  # a value that all names share is a habit of the demonstrations, which nothing has tested
    return ByName(values, probability)


def _true(looks: Mapping[int, tuple[bool, float]]) -> float:
    """The share of the weight of labels that say true."""
    total = sum(weight for _, weight in looks.values())
    return sum(weight for label, weight in looks.values() if label) / total
