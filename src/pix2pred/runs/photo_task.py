"""A task from a photo and a goal alone: the objects are those of the run's demonstrations, and any that are named."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pix2pred.demos.authoring import clean_copy
from pix2pred.learning import load_traces
from pix2pred.predicates.labelling.evidence import load_evidence
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.runs.layout import AS_SAID, EVIDENCE
from pix2pred.structs import Atom, Object, Picture, State, Task, WorldModel, parse_application
from pix2pred.structs.formats.names import DeclaredNames, look_up
from pix2pred.structs.goals.words import parse_goals


class PhotoTaskError(RunFolderError):
    """A goal, an object or an atom that does not fit the run; the message says what would."""


@dataclass(frozen=True, slots=True)
class SceneInWords:
    """What a person says about a scene: goal atoms, objects as ``name:type``, and atoms that hold unseen."""

    goal: Sequence[str]
    objects: Sequence[str] = ()
    given: Sequence[str] = ()


def photo_task(run: RunFolder, model: WorldModel, photos: Sequence[Path], said: SceneInWords) -> Task:
    """The task of reaching ``said.goal`` from the scene on ``photos``, one per camera of the demonstrations.

    Objects that the demonstrations know need not be named; a new one is ``name:type`` or ``name:type:what it looks
    like``. When objects are named, those of the goal, of the given atoms and the named ones are the whole scene;
    otherwise all objects of the demonstrations are. Without a goal the scene is there to be described. Raises
    ``PhotoTaskError``, or ``PictureError`` for a photo that cannot be read.
    """
    names = names_of(model)
    known = known_objects(run)
    try:
        new = [object_in_words(text, names) for text in said.objects if ":" in text]
        known |= {o.name: o for o in new}
        goals = parse_goals(said.goal, lambda written: names.atom(written.name, written.args, known))
        given = frozenset(atom_in_words(text, names, known) for text in said.given)
        named = [look_up("object", text, known) for text in said.objects if ":" not in text]
    except ValueError as error:
        there = ", ".join(f"{o.name} ({o.type.name})" for o in sorted(known.values()))
        raise PhotoTaskError(f"{error}; the demonstrations have {there}, and --thing NAME:TYPE adds another") from error
    goal, *others = goals or ((),)
    used = {o for atoms in (goal, *others, given) for atom in atoms for o in atom.objects} | set(named) | set(new)
    objects = tuple(sorted(used if named else set(known.values())))
    cameras = _cameras(run)
    if len(photos) != len(cameras):
        raise PhotoTaskError(f"--photo: give {len(cameras)}, one for each of {', '.join(cameras)} in this order")
    pictures = tuple(Picture(c, clean_copy(photo, max_side=None), {}) for c, photo in zip(cameras, photos, strict=True))
    return Task(photos[0].stem, objects, State(pictures, {}, given), goal, tuple(others))


def names_of(model: WorldModel) -> DeclaredNames:
    """The types, skills and predicates that words about scenes of ``model`` may use."""
    return DeclaredNames(model.vocabulary.types, model.vocabulary.skills, model.predicates)


def known_objects(run: RunFolder) -> dict[str, Object]:
    """The objects of the run's demonstrations, by name, as they were described to the model."""
    described = {demo.name: demo.descriptors for demo in load_evidence(run.path / EVIDENCE).demos}
    return {
        o.name: Object(o.name, o.type, described.get(demo.name, {}).get(o.name, o.name))
        for demo in load_traces(run.path / AS_SAID).table.demos
        for o in demo.objects
    }


def _cameras(run: RunFolder) -> list[str]:
    demos = load_evidence(run.path / EVIDENCE).demos
    return [picture.camera for picture in demos[0].states[0]]


def object_in_words(text: str, names: DeclaredNames) -> Object:
    """The object in ``name:type`` or ``name:type:what it looks like``. Raises ``ValueError`` without a known type."""
    name, colon, rest = text.partition(":")
    if not colon:
        raise ValueError(f"object {text!r}: its type is missing; write name:type")
    kind, _, looks = rest.partition(":")
    return Object(name.strip(), names.type(kind.strip()), looks.strip() or name.strip())


def atom_in_words(text: str, names: DeclaredNames, objects: dict[str, Object]) -> Atom:
    """The atom in ``On(cup, table)``. Raises ``ValueError`` that says what is wrong with it."""
    application = parse_application(text)
    return names.atom(application.name, application.args, objects)
