"""Labels of episodes are weighed by what was said before and after, and by what operators say that skills do."""

from __future__ import annotations

from collections import Counter

import pytest

from pix2pred.runs.distilling.courses import AskedEpisodes, LabelledLook, Node, Step, weighed_labels
from pix2pred.structs import (
    FromVLM,
    LiftedAtom,
    Operator,
    Predicate,
    Skill,
    Type,
    Variable,
    Vocabulary,
    WorldModel,
)
from pix2pred.structs.knowledge import Reliability

LAMP, BOX = Type("lamp"), Type("box")
ON, OFF, PACK = Skill("SwitchOn", (LAMP,)), Skill("SwitchOff", (LAMP,)), Skill("Pack", (LAMP,))
LIT = Predicate("lit0", (LAMP,), FromVLM("lit"))
FULL = Predicate("full0", (BOX,), FromVLM("full"))
TYPES = {"lamp1": "lamp", "lamp2": "lamp", "box": "box"}
LAMPS = ("lamp1", "lamp2")
X, Y = Variable("?x", LAMP), Variable("?y", BOX)


def operator(name: str, skill: Skill, needs: Lifted, adds: Lifted, deletes: Lifted, *others: Variable) -> Operator:
    return Operator(name, (X, *others), frozenset(needs), frozenset(adds), frozenset(deletes), skill, (X,), 5)


Lifted = set[LiftedAtom]
LIT_X, FULL_Y = LiftedAtom(LIT, (X,)), LiftedAtom(FULL, (Y,))
MODEL = WorldModel(
    Vocabulary("lamps", (LAMP, BOX), (ON, OFF, PACK), ()),
    (LIT, FULL),
    (
        operator("on", ON, set(), {LIT_X}, set()),
        operator("off", OFF, {LIT_X}, set(), {LIT_X}),
        operator("fill", PACK, set(), {FULL_Y}, set(), Y),
        operator("empty", PACK, {FULL_Y}, set(), {FULL_Y}, Y),
    ),
    "large:1",
    (Reliability(LIT, 0.05, 0.0, 0.5), Reliability(FULL, 0.05, 0.0, 0.5)),
)


def episode(asked: AskedEpisodes, labels: list[tuple[bool, bool]], steps: list[Step], name: str = "look") -> list[Node]:
    """Add an episode: one question about two states each, and the labels of every state."""
    nodes: list[Node] = [(t, (f"{name} {t}",)) for t in range(len(labels))]
    for before, after, step in zip(nodes, nodes[1:], steps, strict=False):
        asked.follow([before, after], [step])
    for (_, key), values in zip(nodes, labels, strict=True):
        look = asked.looks.setdefault(key, LabelledLook((), TYPES))
        for lamp, value in zip(LAMPS, values, strict=True):
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
    asked = AskedEpisodes()
    nodes = episode(asked, said, STEPS)
    asked.looks[nodes[0][1]].votes["lit", ("lamp9",)][True] += 1  # an atom about nothing that is there
    weighed = weighed_labels(asked, MODEL)
    for (_, key), values in zip(nodes, TRUTH, strict=True):
        likely = tuple(weighed[key]["lit", (lamp,)] for lamp in LAMPS)
        assert tuple(value for value, _ in likely) == values
        assert all(weight > 0.5 for _, weight in likely)


def test_a_skill_may_change_what_it_is_not_applied_to_where_one_of_its_operators_does() -> None:
    asked, truth = AskedEpisodes(), [False, True, True, False, False, False]
    steps: list[Step] = [
        ("Pack", ("lamp1",)), ("SwitchOn", ("lamp2",)), ("Pack", ("lamp1",)), ("SwitchOff", ("lamp2",)),
        ("SwitchOn", ("lamp1",)),
    ]  # fmt: skip
    nodes = episode(asked, [(False, False)] * 2 + [(False, True)] * 2 + [(False, False), (True, False)], steps)
    for (_, key), full in zip(nodes, truth, strict=True):
        asked.looks[key].votes["full", ("box",)][full] += 1
    weighed = weighed_labels(asked, MODEL)
    assert [weighed[key]["full", ("box",)][0] for _, key in nodes] == truth
    last = nodes[-1][1]
    asked.looks[last].votes["full", ("box",)] = Counter({True: 1})  # switching a lamp on fills no box
    assert not weighed_labels(asked, MODEL)[last]["full", ("box",)][0]


@pytest.mark.parametrize("step", [("Break", ("lamp1",)), ("SwitchOn", ("lamp7",))])
def test_of_skills_and_objects_that_nobody_knows_votes_count_as_they_are(step: Step) -> None:
    asked = AskedEpisodes()
    [first, *_] = episode(asked, TRUTH, [step] * len(STEPS))
    asked.looks[first[1]].votes["lit", ("lamp1",)][True] += 2
    weighed = weighed_labels(asked, MODEL)
    assert weighed[first[1]]["lit", ("lamp1",)] == (True, 1 / 3)
    assert weighed[first[1]]["lit", ("lamp2",)] == (False, 1.0)


def test_every_state_is_in_one_course_where_episodes_part_or_come_back() -> None:
    asked = AskedEpisodes()
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
