"""How far the labels of episodes are to be trusted, by what was said before and after, and by what skills do.

An atom seldom changes, and a skill changes it as it did in the demonstrations: the hidden Markov model of learning
(method 5.7) is fitted to demonstrations and episodes together. Given atoms are not in answers, so that transitions are
told apart by their skill alone.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pix2pred.learning.labels.courses import Courses
from pix2pred.runs.distilling.demonstrations import Taught
from pix2pred.structs import Action, Atom, Candidate, FromVLM, Label, LabelledDemo, Object, Predicate, TruthTable
from pix2pred.vlm.distilled.regions import Names

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
class Asked:
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


def weighed_labels(asked: Asked, found: Taught) -> Mapping[LookKey, Weighed]:
    """For every look the labels that were given, as they are likely to be."""
    weighed = {
        key: {atom: (v[True] > v[False], abs(v[True] - v[False]) / v.total()) for atom, v in look.votes.items()}
        for key, look in asked.looks.items()
    }
    runs = [(looks, demo) for looks, steps in asked.courses() if (demo := _demo(asked, looks, steps, found))]
    table = TruthTable((), tuple(Candidate(p, 0.0) for p in found.predicates), (*found.courses, *(d for _, d in runs)))
    courses = Courses.of(table, found.predicates)
    for number, (looks, demo) in enumerate(runs if courses else (), len(found.courses)):
        for atom in demo.atoms:
            assert courses is not None and isinstance(atom.predicate.source, FromVLM), "atoms of labels"
            key = (str(atom.predicate.source.phrase), tuple(o.name for o in atom.objects))
            for look, belief in zip(looks, courses.beliefs(number, atom) or (), strict=False):
                if key in weighed[look]:
                    weighed[look][key] = (belief > 0.5, abs(2 * belief - 1))
    return weighed


def _demo(asked: Asked, looks: Sequence[LookKey], steps: Sequence[Step], found: Taught) -> LabelledDemo | None:
    """The labels of states that followed one another; none where a type, skill or object is not known."""
    types = {t.name: t for t in found.vocabulary.types}
    skills = {s.name: s for s in found.vocabulary.skills}
    named = {name: kind for key in looks for name, kind in asked.looks[key].types.items()}
    touched = {name for _, names in steps for name in names}
    if set(named.values()) - types.keys() or {skill for skill, _ in steps} - skills.keys() or touched - named.keys():
        return None
    objects = {name: Object(name, types[kind]) for name, kind in named.items()}
    columns: dict[tuple[str, Names], Atom] = {}
    for key in looks:
        for word, names in asked.looks[key].votes:
            about = [objects[n] for n in names if n in objects]
            predicate = _predicate(word, about, found.predicates)
            if predicate is not None and len(about) == len(names):
                columns[word, names] = Atom(predicate, tuple(about))
    values = np.full((len(looks), len(columns)), Label.UNKNOWN, dtype=np.int8)
    for state, key in enumerate(looks):
        for column, atom in enumerate(columns):
            votes = asked.looks[key].votes.get(atom, Counter())
            if votes[True] != votes[False]:
                values[state, column] = Label.of(votes[True] > votes[False])
    actions = tuple(Action(skills[skill], tuple(objects[n] for n in names)) for skill, names in steps)
    return LabelledDemo("episode", tuple(objects.values()), actions, (), tuple(columns.values()), values)


def _predicate(word: str, objects: Sequence[Object], predicates: frozenset[Predicate]) -> Predicate | None:
    """The predicate that a word stands for, asked about these objects."""
    for predicate in sorted(predicates):
        if isinstance(predicate.source, FromVLM) and predicate.source.phrase == word:
            kinds = predicate.types
            if len(kinds) == len(objects) and all(o.type.is_a(t) for o, t in zip(objects, kinds, strict=True)):
                return predicate
    return None
