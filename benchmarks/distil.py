"""Distilled readers: what they know and get right, and what tasks cost with one in front of its teacher.

    python benchmarks/distil.py --domain burger --family combo --rate 0.05 --seed 3 --out runs/distil

The teacher is the noisy oracle: the truth with a share of the labels turned round (--rate). It proposes and labels the
published demonstrations of the seed and labels --episodes closed-loop episodes of other tasks; readers are distilled
from the demonstrations and 0, 5, 20 and 50 of these episodes. Each is asked about --looks looks of other seeds, and
--tasks tasks of another seed are solved in a closed loop with the cascade, and with the teacher alone. A row for each
number of episodes is added to OUT/rows.jsonl; what is there is not computed again. ``--table`` prints all rows.

Scenes, tasks and looks are those of the seed, whatever the rate, and are drawn once and kept in OUT. A state that was
seen before after the same skills of the same task is not drawn again. With --minutes it stops between two pieces of the
work (a few scenes, learning, five episodes, a reader, tasks), and goes on when it is run again.
"""

from __future__ import annotations

import argparse
import json
import pickle
import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, cached_property
from itertools import groupby, product
from pathlib import Path
from typing import Any

import numpy as np

from pix2pred.api import generate
from pix2pred.demos import project_digest
from pix2pred.execution import Solver
from pix2pred.execution.belief.perception import Believing
from pix2pred.learning.labels.advice import Advice
from pix2pred.learning.samplers.file import load_samplers
from pix2pred.pipeline import LearningProblem, ask, fit_samplers, select
from pix2pred.predicates import ground_atoms, labeller_for
from pix2pred.predicates.prompt import atom_text, views
from pix2pred.registry import _said, load_domain, load_planner
from pix2pred.runs.distilling.distil import ReaderSources, distil
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.layout import MODEL, SAMPLERS
from pix2pred.runs.learn import run_config
from pix2pred.runs.save import save_asked, save_selected
from pix2pred.settings import Settings, of_kind, of_project, resolve
from pix2pred.structs import Action, FromVLM, Object, Picture, State, Task, WorldModel
from pix2pred.structs.environment import Environment, SimulatedTask, Step
from pix2pred.structs.formats.world_model import load_model
from pix2pred.structs.views import View
from pix2pred.vlm import VLM, Answer, AnswerStore, Request, StoredVLM
from pix2pred.vlm.distilled.cascade import Cascade
from pix2pred.vlm.distilled.files import WEIGHTS, read_reader
from pix2pred.vlm.distilled.reader import DistilledReader
from pix2pred.vlm.noise.oracle import NoiseRates, NoisyOracle
from pix2pred.vlm.offline.label_question import Look
from pix2pred.vlm.offline.model import WordDoc, load_words
from pix2pred.vlm.offline.prompt_format import KnownWord, states_shown

STEP = 5
"""Episodes that share an answer store."""
EPISODE_SEED, TASK_SEED, LOOK_SEED = 1000, 2000, 3000
"""Added to the seed: none of these scenes is among the demonstrations."""


Digests = tuple[str, ...]


def digests(pictures: Sequence[Picture]) -> Digests:
    return tuple(p.image.digest for p in pictures)


class EnoughError(Exception):
    """The time for one run of the program is used up."""


@dataclass
class Pieces:
    """Pieces of the work, between which the program may stop."""

    minutes: float | None

    def begin(self) -> None:
        if self.minutes is not None and time.process_time() > 60 * self.minutes:
            raise EnoughError


@dataclass(eq=False)
class World:
    """A domain whose truth is noted, state by state, wherever it is looked at."""

    domain: Any
    family: str
    seed: int
    out: Path = Path()
    pieces: Pieces = field(default_factory=lambda: Pieces(None))
    looks: list[tuple[State, Sequence[Object]]] = field(default_factory=list)
    visited: set[int] = field(default_factory=set)
    drawn: dict[tuple[Digests, tuple[Action, ...]], State] = field(default_factory=dict)
    known: dict[Digests, dict[tuple[str, ...], bool | None]] = field(default_factory=dict)

    def load(self) -> None:
        """Take what was drawn by earlier runs of the program."""
        if self._kept.exists():
            self.drawn, self.known, self.looks, self.visited = pickle.loads(self._kept.read_bytes())

    def save(self) -> None:
        """Keep what was drawn for later runs."""
        whole = self._kept.with_suffix(".new")
        whole.write_bytes(pickle.dumps((self.drawn, self.known, self.looks, self.visited)))
        whole.replace(self._kept)

    @property
    def _kept(self) -> Path:
        return self.out / f"{self.domain.name}-{self.family}-{self.seed}.drawn"

    @cached_property
    def words(self) -> dict[tuple[str, tuple[str, ...]], WordDoc]:
        return {(w.word, types): w for w, types in load_words(self.domain.reader).uses() if w.concept is not None}

    def note(self, environment: Environment, state: State, objects: Sequence[Object]) -> None:
        """Remember what is true in the environment's present state, under the digests of its pictures."""
        if (seen := digests(state.pictures)) in self.known:
            self.known[seen] = self.known.pop(seen)  # the latest is the last
            return
        truth: dict[tuple[str, ...], bool | None] = {}
        by_type: dict[str, list[Object]] = {}
        for item in sorted(objects):
            by_type.setdefault(item.type.name, []).append(item)
        for (word, types), doc in self.words.items():
            for chosen in product(*(by_type.get(t, []) for t in types)):
                if len(set(chosen)) == len(chosen):
                    holds = self.domain.concept_holds(environment, doc.concept, [o.name for o in chosen])
                    truth[word, *(o.prompt_name for o in chosen)] = None if holds is None else holds != doc.negated
        self.known[digests(state.pictures)] = truth

    def holds(self, pictures: Sequence[Picture], word: str, names: Sequence[str]) -> bool | None:
        """What is true in a state of which these pictures are shown: of several, in the one looked at last."""
        shown = digests(pictures)
        if (truth := self.known.get(shown)) is None:
            truth = next(known for key, known in reversed(self.known.items()) if set(shown) <= set(key))
        return truth.get((word, *names))

    def visit(self, seed: int) -> list[tuple[State, Sequence[Object]]]:
        """The states of the demonstrations of a seed, with their truth noted."""
        seen = []
        starts = self.domain.demonstration_starts(self.family, seed)
        for start, demo in zip(starts, self.domain.demonstrations(self.family, seed), strict=True):
            environment = self.domain.environment(start.task, start.simulator)
            environment.reset()
            for t, state in enumerate(demo.states):
                if t:
                    environment.execute(demo.actions[t - 1])
                self.note(environment, state, demo.objects)
                seen.append((state, demo.objects))
        return seen

    def environment(self, task: SimulatedTask) -> Watched:
        made = Watched(self, self.domain.environment(task.task, task.simulator), task.task)
        made.reset()
        return made

    @cache  # noqa: B019  (a world lives as long as the program)
    def tasks(self, seed: int, count: int) -> Sequence[SimulatedTask]:
        """The first tasks of another seed, drawn once."""
        path = self._kept.with_suffix(f".{seed}.{count}")
        if not path.exists():
            made = self.domain.tasks(self.family, self.seed + seed, count)
            path.with_suffix(".new").write_bytes(pickle.dumps(made))
            path.with_suffix(".new").replace(path)
        found: Sequence[SimulatedTask] = pickle.loads(path.read_bytes())
        return found

    def fresh(self, wanted: int) -> list[tuple[State, Sequence[Object]]]:
        """States of other seeds: of demonstrations, and the first ones of tasks."""
        if not self.looks:
            self.pieces.begin()
            for task in self.tasks(LOOK_SEED, 40):
                self.environment(task)
                self.looks.append((task.task.initial, task.task.objects))
            self.save()
        while len(self.looks) < wanted:
            self.pieces.begin()
            seed = self.seed + LOOK_SEED + len(self.visited)
            self.looks += self.visit(seed)
            self.visited.add(seed)
            self.save()
        chosen = np.random.default_rng(self.seed).permutation(len(self.looks))[:wanted]
        return [self.looks[i] for i in sorted(chosen)]


@dataclass
class Watched:
    """An environment whose truth is noted whenever it is looked at."""

    world: World
    inner: Environment
    task: Task
    done: list[Action] = field(default_factory=list)

    def reset(self) -> None:
        self.inner.reset()
        self.done.clear()
        self.world.note(self.inner, self.task.initial, self.task.objects)

    def observe(self) -> State:
        course = digests(self.task.initial.pictures), tuple(self.done)
        if course not in self.world.drawn:
            self.world.drawn[course] = self.inner.observe()
        state = self.world.drawn[course]
        self.world.note(self.inner, state, self.task.objects)
        return state

    def features(self) -> Any:
        return self.inner.features()

    def execute(self, action: Action) -> Step:
        self.done.append(action)
        return self.inner.execute(action)

    def goal_reached(self) -> bool:
        return self.inner.goal_reached()


@dataclass(frozen=True)
class Teacher:
    """The noisy oracle. It knows a state by all of its pictures: one camera alone may not see what changed."""

    world: World
    rate: float
    seed: int

    @property
    def name(self) -> str:
        return f"oracle:{self.seed}:{self.rate}"

    def answer(self, request: Request) -> Answer:
        shown = {n: [v.picture for v in views] for n, views in states_shown(request.views).items()}

        def truth(view: View, word: str, names: Sequence[str]) -> bool | None:
            return self.world.holds(shown[view.state], word, names)

        words = [KnownWord(w, types, str(d.concept), d.negated) for (w, types), d in self.world.words.items()]
        return NoisyOracle(words, truth, NoiseRates(flip=self.rate), self.seed).answer(request)


@dataclass
class Counting:
    """Counts questions."""

    model: VLM
    questions: int = 0

    @property
    def name(self) -> str:
        return self.model.name

    def answer(self, request: Request) -> Answer:
        self.questions += 1
        return self.model.answer(request)


@dataclass(eq=False)
class Study:
    """One teacher on one seed of a family."""

    world: World
    rate: float
    out: Path
    grammar: int | None = None

    @cached_property
    def teacher(self) -> Teacher:
        return Teacher(self.world, self.rate, self.world.seed)

    @cached_property
    def run(self) -> RunFolder:
        """The learned run, learned once, without advice about labels; demonstrations are visited for their truth."""
        world, path, kept = self.world, self.out / "run", self.out / "settings"
        if kept.exists():
            self.settings: Settings = pickle.loads(kept.read_bytes())
            return RunFolder(path)
        project = generate(world.domain.name, world.family, world.seed)
        grammar = {} if self.grammar is None else {"grammar": {"max_candidates": self.grammar}}
        layers = of_kind(project.simulator), of_project(project.sections), of_project(grammar)
        self.settings = resolve(*layers)
        world.pieces.begin()
        world.visit(world.seed)
        problem = LearningProblem(
            project.vocabulary, project.demos, StoredVLM(self.teacher, AnswerStore(path)), self.settings
        )
        with RunFolder(path).locked() as run:
            run.claim(run_config(problem, project_digest(project), "oracle", path, project.simulator))
            asked = ask(problem)
            save_asked(run, problem, asked)
            learning = self.settings.learning
            selected = select(project.vocabulary, asked.labelling.table, learning, self.teacher.name)
            save_selected(run, selected, fit_samplers(problem, selected), Advice((), ()), learning, 0)
        kept.write_bytes(pickle.dumps(self.settings))
        return RunFolder(path)

    @cached_property
    def model(self) -> WorldModel:
        return load_model(self.run.path / MODEL)

    def solve(self, vlm: VLM, tasks: Sequence[SimulatedTask]) -> int:
        path = self.run.path / SAMPLERS
        samplers = dict(load_samplers(path)) if path.exists() else {}
        labeller = labeller_for(vlm, self.settings.labels)
        solver = Solver(
            self.model, load_planner("portfolio"), labeller, True, samplers=samplers, perceiving=Believing()
        )
        return sum(solver.solve(t.task, self.world.environment(t)).solved for t in tasks)

    def episodes(self, count: int) -> tuple[Path, ...]:
        """Answer stores with the first ``count`` episodes, a store for each ``STEP`` of them."""
        stores = []
        for first in range(0, count, STEP):
            folder = self.out / f"episodes-{first + STEP}"
            if not (folder / "done").exists():
                self.world.pieces.begin()
                vlm = StoredVLM(self.teacher, AnswerStore(folder))
                self.solve(vlm, self.world.tasks(EPISODE_SEED, count)[first : first + STEP])
                self.world.save()
                (folder / "done").write_text("")
            stores.append(folder)
        return tuple(stores)

    def kept(self, name: str, measure: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        """What was measured under a name, measured once."""
        path = self.out / f"{name}.json"
        if not path.exists():
            self.world.pieces.begin()
            found = measure()
            self.world.save()
            path.write_text(json.dumps(found))
        loaded: dict[str, Any] = json.loads(path.read_text())
        return loaded

    def alone(self, tasks: int) -> dict[str, Any]:
        """Tasks that the teacher solves without a reader, and the questions it is asked."""
        asked = Counting(self.teacher)
        solved = self.solve(asked, self.world.tasks(TASK_SEED, tasks)) if tasks else 0
        return {"solved_by_teacher": solved, "questions_of_teacher": asked.questions}

    def cascaded(self, folder: Path, tasks: int) -> dict[str, Any]:
        """Tasks that are solved with the reader before its teacher, and who said how much."""
        asked = Counting(self.teacher)
        cascade = Cascade(DistilledReader(*read_reader(folder)), asked, _said)
        solved = self.solve(cascade, self.world.tasks(TASK_SEED, tasks)) if tasks else 0
        said = cascade.tally.as_dict()
        counts = {k: said[k] for k in ("by_reader", "by_model", "checked", "differed")}
        return {"tasks": tasks, "solved": solved, "questions": asked.questions} | counts

    def taught(self, folder: Path, stores: tuple[Path, ...]) -> dict[str, Any]:
        """Distil a reader."""
        start = time.process_time()
        distil(ReaderSources(self.run.path, stores), folder)
        return {"distil_seconds": round(time.process_time() - start, 1)}

    def row(self, episodes: int, looks: int, tasks: int) -> dict[str, Any]:
        folder, stores = self.out / f"reader-{episodes}", self.episodes(episodes)
        taught = self.kept(f"taught-{episodes}", lambda: self.taught(folder, stores))
        fresh = self.world.fresh(looks)
        read = self.kept(f"read-{episodes}-{looks}", lambda: self.read(folder, fresh))
        alone = self.kept(f"alone-{tasks}", lambda: self.alone(tasks))
        cascaded = self.kept(f"cascaded-{episodes}-{tasks}", lambda: self.cascaded(folder, tasks))
        _, card, _ = read_reader(folder)
        return {
            "domain": self.world.domain.name, "family": self.world.family, "rate": self.rate, "seed": self.world.seed,
            "episodes": episodes, **read, **cascaded, **alone,
            "looks_taught": card.made_from.looks, "labels": card.made_from.labels, "doubted": card.made_from.doubted,
            "teacher_error": round(float(np.mean([w.teacher_error for w in card.words] or [0.0])), 4),
            "selected": [p.name for p in self.model.selected], "untaught": [u.word for u in card.untaught],
            "kilobytes": round((folder / WEIGHTS).stat().st_size / 1000), **taught,
        }  # fmt: skip

    def read(self, folder: Path, fresh: Sequence[tuple[State, Sequence[Object]]]) -> dict[str, Any]:
        """What the reader says about fresh looks: shares answered, and right of what is answered and of all."""
        model, _, _ = read_reader(folder)
        asked = [p for p in self.model.predicates if isinstance(p.source, FromVLM)]
        count: Counter[str] = Counter()
        start = time.process_time()
        for state, objects in fresh:
            atoms = ground_atoms(asked, objects)
            shown = views(state, 0, objects, marks=False)
            look = Look(tuple(v.picture for v in shown), {o.prompt_name: o.type.name for o in objects})
            texts = [(atom_text(a).partition("(")[0], tuple(o.prompt_name for o in a.objects)) for a in atoms]
            for (word, names), reading in zip(texts, model.read(look, texts), strict=True):
                truth = self.world.holds(look.pictures, word, names)
                if truth is None:
                    continue
                count["atoms"] += 1
                count[f"why {reading.why}"] += 1
                count["answered"] += reading.value is not None
                count["right"] += reading.value == truth
        milliseconds = 1000 * (time.process_time() - start) / max(1, len(fresh))
        return {
            "looks": len(fresh), "atoms": count["atoms"],
            "answered": round(count["answered"] / max(1, count["atoms"]), 4),
            "right": round(count["right"] / max(1, count["answered"]), 4),
            "why": {k[4:]: v for k, v in sorted(count.items()) if k.startswith("why ")},
            "ms_per_look": round(milliseconds, 2),
        }  # fmt: skip


def table(rows: Sequence[dict[str, Any]]) -> str:
    """A line for each domain, rate and number of episodes, over all seeds."""
    cells: dict[tuple[Any, ...], list[dict[str, Any]]] = {}
    for row in rows:
        cells.setdefault((row["domain"], row["family"], row["rate"], row["episodes"]), []).append(row)
    lines = [
        "| domain | family | wrong labels | episodes | answered | right | solved (teacher) | questions (teacher) |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for (domain, family, rate, episodes), found in sorted(cells.items()):
        answered = sum(r["answered"] * r["atoms"] for r in found)
        right = sum(r["right"] * r["answered"] * r["atoms"] for r in found) / max(1.0, answered)
        share = answered / max(1, sum(r["atoms"] for r in found))
        solved, by_teacher = (sum(r[k] for r in found) for k in ("solved", "solved_by_teacher"))
        tasks = sum(r["tasks"] for r in found)
        few, many = (sum(r[k] for r in found) / max(1, tasks) for k in ("questions", "questions_of_teacher"))
        lines.append(
            f"| {domain} | {family} | {rate:.0%} | {episodes} | {share:.1%} | {right:.1%} | {solved} ({by_teacher}) "
            f"of {tasks} | {few:.1f} ({many:.1f}) |"
        )
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--domain", default="burger")
    parser.add_argument("--family", default="combo")
    parser.add_argument("--rate", type=float, nargs="*", default=[0.02, 0.05])
    parser.add_argument("--seed", type=int, nargs="*", default=[3])
    parser.add_argument("--episodes", type=int, nargs="*", default=[0, 5, 20])
    parser.add_argument("--looks", type=int, default=200)
    parser.add_argument("--tasks", type=int, default=10)
    parser.add_argument("--grammar", type=int, help="most feature predicates; 0 leaves those read from pictures alone")
    parser.add_argument("--minutes", type=float, help="begin no row after so many CPU minutes; run again for the rest")
    parser.add_argument("--out", type=Path, default=Path("runs/distil"))
    parser.add_argument("--table", action="store_true")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    path = arguments.out / "rows.jsonl"
    rows = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    if arguments.table:
        print(table(rows))
        return
    done = {(r["domain"], r["family"], r["rate"], r["seed"], r["episodes"]) for r in rows}
    asked = product(arguments.seed, arguments.rate, arguments.episodes)
    left = [r for r in asked if (arguments.domain, arguments.family, r[1], r[0], r[2]) not in done]
    with suppress(EnoughError):
        for seed, of_seed in groupby(left, key=lambda r: r[0]):
            world = World(load_domain(arguments.domain), arguments.family, seed, arguments.out)
            world.pieces = Pieces(arguments.minutes)
            world.load()
            for rate, of_rate in groupby(of_seed, key=lambda r: r[1]):
                name = f"{arguments.domain}-{arguments.family}-{rate:g}-{seed}"
                study = Study(world, rate, arguments.out / name, arguments.grammar)
                for _, _, episodes in of_rate:
                    row = study.row(episodes, arguments.looks, arguments.tasks)
                    world.save()
                    with path.open("a") as stream:
                        stream.write(json.dumps(row) + "\n")
                    print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
