"""How far the labels of episodes are to be trusted, by what was said before and after, and by what skills do.

An atom is a hidden Markov chain as in learning (method 5.7): its labels err as the world model says, and a skill
changes it as the operators of the skill do. Given atoms are not in answers, so that nobody says which operator applied.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pix2pred.execution.belief.belief import MOST_ERROR
from pix2pred.execution.belief.settings import DEFAULTS as BELIEF
from pix2pred.learning.labels.messages import backward, forward
from pix2pred.structs import Action, Atom, FromVLM, Label, Object, Predicate, WorldModel
from pix2pred.vlm.distilled.regions import Names

LEAST_ERROR = 0.01
"""Of a teacher, and of what is believed of the first state: nobody is right always."""
TINY = 1e-9
"""Where no operator applies, none of them changes anything."""
LookKey = tuple[str, ...]
"""The digests of a state's pictures, camera by camera."""
Node = tuple[int, LookKey]
"""A state of an episode: its number there, and how it looks."""
Step = tuple[str, Names]
"""A skill and the names of its objects."""
Weighed = dict[tuple[str, Names], tuple[bool, float]]
"""By word and objects the likely value, and how far it is to be trusted, from 0 to 1."""


@dataclass(slots=True)
class LabelledLook:
    """A state that questions were about: its pictures as they were shown, and the votes for each atom."""

    pictures: Sequence[dict[str, Any]]
    types: dict[str, str]
    votes: defaultdict[tuple[str, Names], Counter[bool]] = field(default_factory=lambda: defaultdict(Counter))

    def majority(self, word: str, names: Names) -> bool:
        """What was said more often of an atom."""
        votes = self.votes[word, names]
        return votes[True] > votes[False]


@dataclass(slots=True)
class AskedEpisodes:
    """What was asked about: all states, and which followed which by what skill."""

    looks: dict[LookKey, LabelledLook] = field(default_factory=dict)
    after: defaultdict[Node, dict[Node, Step]] = field(default_factory=lambda: defaultdict(dict))
    _parent: dict[LookKey, LookKey] = field(default_factory=dict)

    def follow(self, nodes: Sequence[Node], steps: Sequence[Step]) -> None:
        """Note that states were shown together, in this order, and the skills between them where all are told."""
        for node in nodes:
            self.after[node]
            first, second = sorted((self.root(nodes[0][1]), self.root(node[1])))
            self._parent[second] = first  # the smaller name stands for both, whatever the order
        if len(steps) == len(nodes) - 1:
            for before, after, step in zip(nodes, nodes[1:], steps, strict=False):
                self.after[before][after] = step

    def root(self, key: LookKey) -> LookKey:
        """The state that stands for the episode of ``key``: that of all which were shown together, and so on."""
        self._parent.setdefault(key, key)
        while (above := self._parent[key]) != key:
            self._parent[key] = self._parent[above]
            key = above
        return key

    def courses(self) -> Iterator[tuple[list[LookKey], list[Step]]]:
        """Every state once, in runs that follow one another; where two follow, one of them begins another run."""
        used = set[Node]()
        for first in sorted(self.after):
            if first in used:
                continue
            run, steps, node = [first[1]], list[Step](), first
            used.add(node)
            while following := [n for n in sorted(self.after[node]) if n not in used]:
                steps.append(self.after[node][following[0]])
                node = following[0]
                used.add(node)
                run.append(node[1])
            yield run, steps


def weighed_labels(asked: AskedEpisodes, model: WorldModel) -> Mapping[LookKey, Weighed]:
    """For every look the labels that were given, as they are likely to be.

    Where skills, types or objects are not of the model, and for words that it does not use, what was said more often.
    """
    weighed = {
        key: {atom: (v[True] > v[False], abs(v[True] - v[False]) / v.total()) for atom, v in look.votes.items()}
        for key, look in asked.looks.items()
    }
    for looks, steps in asked.courses():
        course = _course(asked, looks, steps, model)
        if course is None or not course.columns:
            continue
        for (word, names), beliefs in zip(course.columns, course.beliefs(model), strict=True):
            for look, belief in zip(looks, beliefs.tolist(), strict=True):
                if (word, names) in weighed[look]:
                    weighed[look][word, names] = (belief > 0.5, abs(2 * belief - 1))
    return weighed


@dataclass(frozen=True, slots=True)
class _Course:
    """States that followed one another. ``values`` holds labels of shape (columns, states)."""

    objects: tuple[Object, ...]
    actions: tuple[Action, ...]
    columns: Mapping[tuple[str, Names], Atom]
    values: NDArray[np.int8]

    def beliefs(self, model: WorldModel) -> NDArray[np.float64]:
        """The probability that each atom is true in each state, from all labels, by messages along the course."""
        atoms = list(self.columns.values())
        known = {r.predicate: r for r in model.reliability}
        error = [known[a.predicate].error if a.predicate in known else BELIEF.error for a in atoms]
        wrong = np.clip(error, LEAST_ERROR, MOST_ERROR)[:, None]
        first = [known[a.predicate].initially if a.predicate in known else BELIEF.initially for a in atoms]
        like_true = np.where(self.values == Label.TRUE, 1 - wrong, np.where(self.values == Label.FALSE, wrong, 1.0))
        like_false = np.where(self.values == Label.TRUE, wrong, np.where(self.values == Label.FALSE, 1 - wrong, 1.0))
        changes = [_changes(model, action, self.objects, atoms) for action in self.actions]
        shape = (2, len(atoms), len(changes))
        up, down = np.stack(changes, axis=2) if changes else np.zeros(shape)
        prior = np.clip(first, LEAST_ERROR, 1 - LEAST_ERROR)
        ahead = forward(like_true, like_false, up, down, prior)
        true = ahead * (behind := backward(like_true, like_false, up, down))
        found: NDArray[np.float64] = true / (true + (1 - ahead) * (1 - behind))
        return found


def _changes(
    model: WorldModel, action: Action, objects: tuple[Object, ...], atoms: Sequence[Atom]
) -> NDArray[np.float64]:
    """How probably a skill makes each atom true if it is false, and false if it is true: of shape (2, atoms).

    Nobody says which of its operators applied, nor to which objects beside those of the skill. All count, by the
    transitions they were learned from; those that need an atom do not where it is false.
    """
    effects = [
        (max(1, operator.support) / len(ways), way)
        for operator in model.operators
        if operator.skill == action.skill
        and (ways := list(operator.groundings(dict(zip(operator.skill_args, action.objects, strict=True)), objects)))
        for way in ways
    ]
    if not effects:
        return np.full((2, len(atoms)), 0.5)
    found = np.zeros((2, len(atoms)))
    for column, atom in enumerate(atoms):
        can = [(weight, way) for weight, way in effects if atom not in way.preconditions]
        rises = sum(weight for weight, way in can if atom in way.add)
        falls = sum(weight for weight, way in effects if atom in way.delete)
        found[0, column] = rises / max(sum(weight for weight, _ in can), TINY)
        found[1, column] = falls / max(sum(weight for weight, _ in effects), TINY)
    happens: NDArray[np.float64] = BELIEF.drift + (1 - BELIEF.fails_unreported - BELIEF.drift) * found
    return happens


def _course(asked: AskedEpisodes, looks: Sequence[LookKey], steps: Sequence[Step], model: WorldModel) -> _Course | None:
    """The labels of states that followed one another; none where a type, skill or object is not known."""
    types = {t.name: t for t in model.vocabulary.types}
    skills = {s.name: s for s in model.vocabulary.skills}
    named = {name: kind for key in looks for name, kind in asked.looks[key].types.items()}
    touched = {name for _, names in steps for name in names}
    if set(named.values()) - types.keys() or touched - named.keys():
        return None
    if any(skill not in skills or len(skills[skill].types) != len(names) for skill, names in steps):
        return None
    objects = {name: Object(name, types[kind]) for name, kind in named.items()}
    columns: dict[tuple[str, Names], Atom] = {}
    for key in looks:
        for word, names in asked.looks[key].votes:
            about = [objects[n] for n in names if n in objects]
            predicate = _predicate(word, about, model.predicates)
            if predicate is not None and len(about) == len(names):
                columns[word, names] = Atom(predicate, tuple(about))
    values = np.full((len(columns), len(looks)), Label.UNKNOWN, dtype=np.int8)
    for state, key in enumerate(looks):
        for column, atom in enumerate(columns):
            votes = asked.looks[key].votes.get(atom, Counter())
            if votes[True] != votes[False]:
                values[column, state] = Label.of(votes[True] > votes[False])
    actions = tuple(Action(skills[skill], tuple(objects[n] for n in names)) for skill, names in steps)
    return _Course(tuple(objects.values()), actions, columns, values)


def _predicate(word: str, objects: Sequence[Object], predicates: Sequence[Predicate]) -> Predicate | None:
    """The predicate that a word stands for, asked about these objects."""
    for predicate in predicates:
        if isinstance(predicate.source, FromVLM) and predicate.source.phrase == word:
            kinds = predicate.types
            if len(kinds) == len(objects) and all(o.type.is_a(t) for o, t in zip(objects, kinds, strict=True)):
                return predicate
    return None
