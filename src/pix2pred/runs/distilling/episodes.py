"""What answers in a store teach beyond the demonstrations: the labels that were asked for while tasks were solved."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from pix2pred.predicates.frugal.histories import HistoryFormat
from pix2pred.predicates.labelling.label_format import LabelFormat
from pix2pred.runs.distilling.demonstrations import LEAST_WEIGHT, Taught
from pix2pred.runs.distilling.pictures import Stores
from pix2pred.structs import Label, Picture
from pix2pred.vlm import AnswerStore, Finish, Purpose
from pix2pred.vlm.answers.inspection import StoredEntry, read_all
from pix2pred.vlm.distilled.fitting.lesson import Example
from pix2pred.vlm.distilled.looks import Look
from pix2pred.vlm.distilled.regions import Names
from pix2pred.vlm.offline.prompt_format import asked_atoms, object_types

LookKey = tuple[str, ...]
"""The digests of a state's pictures, camera by camera."""

_LABELLING = frozenset({Purpose.LABEL, Purpose.DOUBLE_CHECK, Purpose.HISTORY, Purpose.ASK_AGAIN})


@dataclass(slots=True)
class _Labelled:
    """A state that questions were about: its pictures as they were shown, and the votes for each atom."""

    pictures: Sequence[dict[str, Any]]
    types: dict[str, str]
    votes: defaultdict[tuple[str, Names], Counter[bool]] = field(default_factory=lambda: defaultdict(Counter))


def add_episodes(found: Taught, answers: AnswerStore, teacher: str, stores: Stores) -> int:
    """Add what ``teacher`` said in ``answers`` about states that are not there yet; gives how many were added."""
    labelled: dict[LookKey, _Labelled] = {}
    episodes = _Joined()
    for entry in read_all(answers):
        if entry.model == teacher and entry.purpose in _LABELLING and entry.answer.finish == Finish.COMPLETE:
            _read(entry, found.words, labelled, episodes)
    before = len(found.looks)
    names: dict[LookKey, str] = {}
    for key, state in labelled.items():
        if key in found.digests or not state.votes:
            continue
        pictures = tuple(_pictures(state, stores))
        if len(pictures) < len(state.pictures):
            found.lost += 1
            continue
        episode = names.setdefault(episodes.root(key), f"episode {found.episodes + len(names)}")
        number = found.add(Look(pictures, state.types), episode)
        for (word, objects), votes in state.votes.items():
            weight = abs(votes[True] - votes[False]) / votes.total()
            if weight >= LEAST_WEIGHT:
                found.examples.append(Example(number, word, objects, votes[True] > votes[False], weight))
    found.episodes += len(names)
    return len(found.looks) - before


def _read(entry: StoredEntry, words: set[str], labelled: dict[LookKey, _Labelled], episodes: _Joined) -> None:
    text = "\n\n".join(entry.texts)
    states = _states(entry)
    if not states:
        return
    atoms = {str(atom): atom for atom in asked_atoms(text) if atom.word in words}
    keys = {number: tuple(str(p["pixels"]) for p in pictures) for number, pictures in states.items()}
    for key in keys.values():
        episodes.join(next(iter(keys.values())), key)
    for number, values in _values(entry, list(atoms), sorted(states)).items():
        state = labelled.setdefault(keys[number], _Labelled(states[number], object_types(text)))
        for atom, label in values.items():
            if label != Label.UNKNOWN:
                state.votes[atoms[atom].word, atoms[atom].names][label == Label.TRUE] += 1


def _values(entry: StoredEntry, atoms: list[str], numbers: list[int]) -> dict[int, dict[str, Label]]:
    """The labels of an answer by the number of the state: of the latest, or of all when it is about a history."""
    if entry.purpose == Purpose.HISTORY:
        histories = HistoryFormat(tuple(numbers)).read(entry.answer.text, atoms).values
        return {n: {atom: history[i] for atom, history in histories.items()} for i, n in enumerate(numbers)}
    return {numbers[-1]: LabelFormat().read(entry.answer.text, atoms).values}


def _states(entry: StoredEntry) -> dict[int, list[dict[str, Any]]]:
    """The uncropped pictures by the number of the state, in ascending order."""
    states: defaultdict[int, list[dict[str, Any]]] = defaultdict(list)
    for picture in entry.pictures:
        if picture.get("crop") is None:
            states[int(picture.get("state", 0))].append(picture)
    return dict(sorted(states.items()))


def _pictures(state: _Labelled, stores: Stores) -> Iterator[Picture]:
    for shown in state.pictures:
        picture = stores.picture(str(shown.get("camera", "")), str(shown["pixels"]), shown.get("boxes", {}))
        if picture is not None:
            yield picture


@dataclass(slots=True)
class _Joined:
    """Which states belong to one episode: those that were shown together, and so on."""

    parent: dict[LookKey, LookKey] = field(default_factory=dict)

    def root(self, key: LookKey) -> LookKey:
        """The state that stands for the episode of ``key``."""
        self.parent.setdefault(key, key)
        while (above := self.parent[key]) != key:
            self.parent[key] = self.parent[above]
            key = above
        return key

    def join(self, one: LookKey, other: LookKey) -> None:
        """Note that two states belong together; the smaller name stands for both, whatever the order."""
        first, second = sorted((self.root(one), self.root(other)))
        self.parent[second] = first
