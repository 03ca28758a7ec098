"""Two answerers who read ten vague words differently: one labels the demonstrations, the other looks at the tasks.

    python benchmarks/two_answerers.py --seeds 0 1 2

Every word has two readings, each with a sentence that says it. An answerer knows the simulator's truth, reads a word
in its own way, and keeps to a sentence that the question tells. Combo Burger is learned and solved with the frugal
protocol, by one answerer or by two, where the first had told no meanings and where the second is told them.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum

from burger_pool import demonstration_worlds
from pix2pred.domains.burger import BurgerDomain
from pix2pred.domains.burger.families import load_families
from pix2pred.domains.burger.truth import concept_value
from pix2pred.domains.burger.world import BurgerWorld
from pix2pred.execution import Solver
from pix2pred.pipeline import LearningProblem, learn
from pix2pred.predicates import labeller_for
from pix2pred.registry import REGISTRY
from pix2pred.settings import Layer, resolve
from pix2pred.vlm import Answer, Purpose, Request
from pix2pred.vlm.offline.prompt_format import KnownWord, asked_atoms, definition_answer, history_line, states_shown

FAMILY = "combo"
ITEMS = ("patty", "lettuce", "bottom_bun", "top_bun")
STATIONS = ("grill", "cutting_board")
_MEANING = re.compile(r"^- (\w+)\([^:]*: (.*)$", re.MULTILINE)


class Side(IntEnum):
    """Whose reading of a word."""

    LABELS = 0
    LOOKS = 1


Value = Callable[..., bool]


@dataclass(frozen=True)
class VagueWord:
    """A word, the types it is used for, and two readings: a sentence and what it says of a world."""

    types: tuple[tuple[str, ...], ...]
    sentences: tuple[str, str]
    values: tuple[Value, Value]


def _is(concept: str) -> Value:
    return lambda world, *names: concept_value(world, concept, names)


def _distance(world: BurgerWorld, a: str, b: str) -> int:
    one, other = world.where(a), world.where(b)
    return abs(one.row - other.row) + abs(one.col - other.col)


def _not(value: Value) -> Value:
    return lambda *arguments: not value(*arguments)


def _alone(world: BurgerWorld, robot: str) -> bool:
    return not any(_distance(world, robot, t.name) <= 1 for t in world.things if t.name not in (robot, world.held))


HELD, COVERED, ADJACENT, FACING = _is("held"), _is("covered"), _is("adjacent"), _is("facing")
WORDS: Mapping[str, VagueWord] = {
    "done": VagueWord(
        (("patty",),),
        ("It is brown, wherever it is.", "Nothing is being done to it: it does not lie on the grill."),
        (_is("cooked"), _not(_is("on_station"))),
    ),
    "prepared": VagueWord(
        (("lettuce",),),
        ("It has been cut into strips.", "It is ready to be taken: nothing lies on it and it is not held."),
        (_is("chopped"), lambda w, n: not COVERED(w, n) and not HELD(w, n)),
    ),
    "free": VagueWord(
        (("robot",),),
        ("Its hand is empty.", "Nothing stands beside it."),
        (_is("hand_empty"), _alone),
    ),
    "near": VagueWord(
        tuple(("robot", item) for item in ITEMS),
        ("The second is in a cell beside the first.", "The second is at most three cells away from the first."),
        (ADJACENT, lambda w, a, b: _distance(w, a, b) <= 3),
    ),
    "at": VagueWord(
        tuple(("robot", station) for station in STATIONS),
        ("The first is in a cell beside the second.", "The first faces the second."),
        (ADJACENT, FACING),
    ),
    "clear": VagueWord(
        tuple((item,) for item in ITEMS),
        ("Nothing lies on it, also while it is held.", "Nothing lies on it, and it is not held."),
        (_not(COVERED), lambda w, n: not COVERED(w, n) and not HELD(w, n)),
    ),
    "above": VagueWord(
        tuple((a, b) for a in ITEMS for b in ITEMS if a != b),
        ("The first lies directly on the second.", "The first lies somewhere above the second."),
        (_is("on"), _is("above")),
    ),
    "busy": VagueWord(
        tuple((station,) for station in STATIONS),
        ("Something lies on it.", "Something lies on it or somebody faces it."),
        (_is("occupied"), lambda w, n: concept_value(w, "occupied", (n,)) or FACING(w, w.robot, n)),
    ),
    "loose": VagueWord(
        tuple((item,) for item in ITEMS),
        ("It lies on the floor with nothing on it.", "It lies on the floor."),
        (lambda w, n: concept_value(w, "on_ground", (n,)) and not COVERED(w, n), _is("on_ground")),
    ),
    "part": VagueWord(
        tuple((item,) for item in ITEMS),
        ("It lies on something or something lies on it.", "It lies on another item."),
        (_is("stacked"), lambda w, n: not HELD(w, n) and w.thing(n).z > 0),
    ),
}  # fmt: skip


class Answerer:
    """Knows the world behind every picture, and reads the words in its own way where nobody tells another one."""

    def __init__(self, worlds: Mapping[str, BurgerWorld], side: Side, tells: bool) -> None:
        self.name = f"oracle:{side.name.lower()}"
        self._worlds = worlds
        self._side = side
        self._tells = tells

    def answer(self, request: Request) -> Answer:
        if request.purpose == Purpose.DEFINE:
            words = [KnownWord(word, types, word, False) for word, vague in WORDS.items() for types in vague.types]
            said = {word: vague.sentences[self._side] if self._tells else " " for word, vague in WORDS.items()}
            return Answer(definition_answer(request.text, words, said))
        told = dict(_MEANING.findall(request.text))
        worlds = {n: self._worlds[views[0].picture.image.digest] for n, views in states_shown(request.views).items()}
        lines = []
        for atom in asked_atoms(request.text):
            value = self._reading(atom.word, told.get(atom.word, ""))
            lines.append(history_line(atom, {n: value(world, *atom.names) for n, world in worlds.items()}))
        return Answer("\n".join(lines))

    def _reading(self, word: str, told: str) -> Value:
        vague = WORDS[word]
        for sentence, value in zip(vague.sentences, vague.values, strict=True):
            if sentence in told:
                return value
        return vague.values[self._side]


def run(seed: int, count: int) -> dict[str, int]:
    """Tasks solved of ``count`` by who looked and what was told."""
    domain, family = BurgerDomain(), load_families()[FAMILY]
    demos, tasks = domain.demonstrations(FAMILY, seed), domain.tasks(FAMILY, seed, count)
    worlds = {t.task.initial.pictures[0].image.digest: BurgerWorld.from_dict(t.simulator["world"]) for t in tasks}
    for index, demo in enumerate(demos):
        for state, world in zip(demo.states, demonstration_worlds(family, index, seed), strict=True):
            worlds[state.pictures[0].image.digest] = world
    chosen = Layer({"labels": {"protocol": "frugal"}, "learning": {"operators": "robust"}}, "the benchmark")
    settings = resolve(Layer({"learning": dict(domain.settings(FAMILY))}, "the domain"), chosen)
    solved = {}
    for tells in (False, True):
        first = Answerer(worlds, Side.LABELS, tells)
        learned = learn(LearningProblem(domain.vocabulary(FAMILY), demos, first, settings))
        for side in Side:
            labeller = labeller_for(Answerer(worlds, side, tells), settings.labels)
            solver = Solver(learned.model, REGISTRY.planner("portfolio"), labeller, samplers=learned.samplers)
            who = "the same answerer" if side is Side.LABELS else "another answerer"
            solved[f"{who}, {'with' if tells else 'without'} meanings"] = sum(
                solver.solve(t.task, domain.environment(t.task, t.simulator)).solved for t in tasks
            )
        print(f"seed {seed}: selected {', '.join(p.name for p in learned.model.selected)}", flush=True)
    return solved


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", nargs="*", type=int, default=[0, 1, 2])
    parser.add_argument("--count", type=int, default=10, help="tasks per seed")
    arguments = parser.parse_args()
    rows = [run(seed, arguments.count) for seed in arguments.seeds]
    for setting in rows[0]:
        print(f"{setting}: {sum(r[setting] for r in rows)} of {arguments.count * len(rows)}")


if __name__ == "__main__":
    main()
