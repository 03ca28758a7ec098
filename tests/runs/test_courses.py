"""Labels of episodes are weighed by what was said before and after, and by what skills did in demonstrations."""

from __future__ import annotations

import numpy as np
import pytest

from pix2pred.runs.distilling.courses import Asked, LabelledLook, Node, Step, weighed_labels
from pix2pred.runs.distilling.demonstrations import Taught
from pix2pred.structs import Action, Atom, FromVLM, LabelledDemo, Object, Predicate, Skill, Type, Vocabulary

LAMP = Type("lamp")
ON, OFF = Skill("SwitchOn", (LAMP,)), Skill("SwitchOff", (LAMP,))
LIT = Predicate("lit0", (LAMP,), FromVLM("lit"))
TYPES = {"lamp1": "lamp", "lamp2": "lamp"}


def demonstration(number: int, rng: np.random.Generator) -> LabelledDemo:
    """Lamps that are switched on and off, and two columns of labels without errors."""
    lamps = tuple(Object(name, LAMP) for name in TYPES)
    held, actions = [[False, False]], []
    for _ in range(6):
        i = int(rng.integers(2))
        actions.append(Action(OFF if held[-1][i] else ON, (lamps[i],)))
        held.append([not h if j == i else h for j, h in enumerate(held[-1])])
    atoms = tuple(Atom(LIT, (lamp,)) for lamp in lamps)
    return LabelledDemo(f"demo {number}", lamps, tuple(actions), (), atoms, np.array(held, dtype=np.int8))


def taught() -> Taught:
    rng = np.random.default_rng(0)
    return Taught(Vocabulary("lamps", (LAMP,), (ON, OFF), ()), frozenset({LIT}), tuple(
        demonstration(i, rng) for i in range(6)
    ))  # fmt: skip


def episode(asked: Asked, labels: list[tuple[bool, bool]], steps: list[Step], name: str = "look") -> list[Node]:
    """Add an episode: one question about two states each, and the labels of every state."""
    nodes: list[Node] = [(t, (f"{name} {t}",)) for t in range(len(labels))]
    for before, after, step in zip(nodes, nodes[1:], steps, strict=False):
        asked.follow([before, after], [step])
    for (_, key), values in zip(nodes, labels, strict=True):
        look = asked.looks.setdefault(key, LabelledLook((), TYPES))
        for lamp, value in zip(TYPES, values, strict=True):
            look.votes["lit", (lamp,)][value] += 1
    return nodes


STEPS: list[Step] = [
    ("SwitchOn", ("lamp1",)), ("SwitchOn", ("lamp2",)), ("SwitchOff", ("lamp1",)), ("SwitchOn", ("lamp1",)),
    ("SwitchOff", ("lamp2",)),
]  # fmt: skip
TRUTH = [(False, False), (True, False), (True, True), (False, True), (True, True), (True, False)]


def test_a_label_that_contradicts_what_skills_do_is_turned_round() -> None:
    said = [*TRUTH]
    said[2] = (False, True)  # lamp1 was switched on, and is still on after lamp2
    said[4] = (False, True)  # lamp1 was just switched on again
    asked = Asked()
    nodes = episode(asked, said, STEPS)
    asked.looks[nodes[0][1]].votes["lit", ("lamp9",)][True] += 1  # an atom about nothing that is there
    weighed = weighed_labels(asked, taught())
    for (_, key), values in zip(nodes, TRUTH, strict=True):
        likely = tuple(weighed[key]["lit", (lamp,)] for lamp in TYPES)
        assert tuple(value for value, _ in likely) == values
        assert all(weight > 0.5 for _, weight in likely)


@pytest.mark.parametrize("step", [("Break", ("lamp1",)), ("SwitchOn", ("lamp7",))])
def test_of_skills_and_objects_that_nobody_knows_votes_count_as_they_are(step: Step) -> None:
    asked = Asked()
    [first, *_] = episode(asked, TRUTH, [step] * len(STEPS))
    asked.looks[first[1]].votes["lit", ("lamp1",)][True] += 2
    weighed = weighed_labels(asked, taught())
    assert weighed[first[1]]["lit", ("lamp1",)] == (True, 1 / 3)
    assert weighed[first[1]]["lit", ("lamp2",)] == (False, 1.0)


def test_every_state_is_in_one_course_where_episodes_part_or_come_back() -> None:
    asked = Asked()
    episode(asked, TRUTH[:3], STEPS)
    start = (0, ("look 0",))
    asked.follow([start, (1, ("other",))], [("SwitchOn", ("lamp2",))])
    asked.follow([(2, ("look 2",)), (3, ("look 0",))], [("SwitchOff", ("lamp1",))])  # it looks as in the beginning
    asked.follow([(0, ("elsewhere",))], [])
    runs = list(asked.courses())
    assert [looks for looks, _ in runs] == [
        [("elsewhere",)], [("look 0",), ("look 1",), ("look 2",), ("look 0",)], [("other",)]
    ]  # fmt: skip
    assert all(len(steps) == len(looks) - 1 for looks, steps in runs)
    roots = {key: asked.root(key) for looks, _ in runs for key in looks}
    assert len(set(roots.values())) == 2 and roots["other",] == roots["look 2",]
