"""What answers in a store teach beyond the demonstrations: the labels that were asked for while tasks were solved."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from typing import Any

from pix2pred.predicates.frugal.histories import HistoryFormat
from pix2pred.predicates.labelling.label_format import LabelFormat
from pix2pred.runs.distilling.courses import AskedEpisodes, LabelledLook, LookKey, weighed_labels
from pix2pred.runs.distilling.demonstrations import LEAST_WEIGHT, TeachingMaterial
from pix2pred.runs.distilling.pictures import Stores
from pix2pred.structs import Label, Picture
from pix2pred.vlm import AnswerStore, Finish, Purpose
from pix2pred.vlm.answers.inspection import StoredEntry, read_all
from pix2pred.vlm.distilled.fitting.lesson import Example
from pix2pred.vlm.offline.label_question import Look
from pix2pred.vlm.offline.prompt_format import asked_atoms, executed_skills, object_types

_LABELLING = frozenset({Purpose.LABEL, Purpose.DOUBLE_CHECK, Purpose.HISTORY, Purpose.ASK_AGAIN})


def add_episodes(found: TeachingMaterial, answers: AnswerStore, teacher: str, stores: Stores) -> int:
    """Add what ``teacher`` said in ``answers`` about states that are not there yet; gives how many were added."""
    asked = AskedEpisodes()
    for entry in read_all(answers):
        if entry.model == teacher and entry.purpose in _LABELLING and entry.answer.finish == Finish.COMPLETE:
            _read(entry, found.words, asked)
    before, known = len(found.looks), set(found.digests)
    names: dict[LookKey, str] = {}
    weighed = weighed_labels(asked, found.model)
    for key, state in asked.looks.items():
        if key in known or not state.votes:
            continue
        pictures = tuple(_pictures(state, stores))
        if len(pictures) < len(state.pictures):
            found.lost += 1
            continue
        episode = names.setdefault(asked.root(key), f"episode {found.episodes + len(names)}")
        number = found.add(Look(pictures, state.types), episode, key)
        for (word, objects), (label, weight) in weighed[key].items():
            if weight >= LEAST_WEIGHT:
                found.examples.append(Example(number, word, objects, label, weight))
            found.doubted += label != state.majority(word, objects) or weight < LEAST_WEIGHT
    found.episodes += len(names)
    return len(found.looks) - before


def _read(entry: StoredEntry, words: set[str], asked: AskedEpisodes) -> None:
    text = "\n\n".join(entry.texts)
    states = _states(entry)
    if not states:
        return
    atoms = {str(atom): atom for atom in asked_atoms(text) if atom.word in words}
    keys = {number: tuple(str(p["pixels"]) for p in pictures) for number, pictures in states.items()}
    asked.follow(list(keys.items()), executed_skills(text))
    types = object_types(text)
    for number, shown in states.items():
        asked.looks.setdefault(keys[number], LabelledLook(shown, types))
    for number, values in _values(entry, list(atoms), sorted(states)).items():
        votes = asked.looks[keys[number]].votes
        for atom, label in values.items():
            if label != Label.UNKNOWN:
                votes[atoms[atom].word, atoms[atom].names][label == Label.TRUE] += 1


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


def _pictures(state: LabelledLook, stores: Stores) -> Iterator[Picture]:
    for shown in state.pictures:
        picture = stores.picture(str(shown.get("camera", "")), str(shown["pixels"]), shown.get("boxes", {}))
        if picture is not None:
            yield picture
