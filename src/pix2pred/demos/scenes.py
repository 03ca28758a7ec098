"""From a demonstration's or task's file to objects, atoms, actions and states (method 1.1 to 1.4)."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from pix2pred.demos.declared import Declared, resolve_objects
from pix2pred.demos.files.documents import Sheet, StateDoc
from pix2pred.demos.files.problems import Problem
from pix2pred.demos.files.unfilled import ask_for_action, ask_for_atom, is_unfilled
from pix2pred.demos.files.yaml_lines import Loc
from pix2pred.demos.pictures import PictureCheck, Shown, find_pictures
from pix2pred.structs import Action, Application, Atom, Box, Image, Object, Picture, State, parse_application
from pix2pred.structs.formats.documents import ObjectDoc
from pix2pred.structs.formats.names import DeclaredNames, UnknownNameError
from pix2pred.structs.goals.words import Literal, combined, parse_goal
from pix2pred.structs.skills import FAILED

_INSIDE = re.compile(r"([^\[\]]*?),?\s*(\[[^\[\]]*\])\s*\)\s*\Z")
"""An action whose parameters stand behind its objects, as the method's authors write them: ``pick(cup, hand, [])``."""

_WORDS = re.compile(r"(?:^|[\s()])(?:[Nn]ot|NOT|and|or)(?=[\s(]|\Z)|[!~\u00ac]")
"""A goal that is more than an atom."""


class SceneReader:
    """The objects of one file, and everything said about them. Problems go to the sheet; reading goes on."""

    def __init__(self, sheet: Sheet, declared: Declared, root: Path, warned: list[Problem] | None = None) -> None:
        """``root`` is the project folder, which pictures must not leave.

        Pictures are looked into only when there is a list for what is ``warned`` of.
        """
        vocabulary = declared.vocabulary
        self.incomplete = False
        """Whether something was left out because its declaration has a problem, reported there."""
        self._sheet = sheet
        self._declared = declared
        self._root = root
        self._names = DeclaredNames(vocabulary.types, vocabulary.skills, vocabulary.initial)
        self._broken = set(declared.broken)
        self._objects: dict[str, Object] = {}
        self._cameras: tuple[str, ...] | None = None
        self._features: bool | None = None
        self._check = PictureCheck(sheet, warned) if warned is not None else None

    def objects(self, docs: Sequence[str] | Mapping[str, ObjectDoc]) -> tuple[Object, ...]:
        """The objects of the scene, in the order written."""
        if isinstance(docs, Mapping):
            self._objects = resolve_objects(self._sheet, docs, self._names.types, self._broken)
        else:
            for i, name in enumerate(docs):
                self._list_object(("objects", i), name)
        descriptors: dict[str, str] = {}
        for name, item in self._objects.items():
            spoken = item.prompt_name.lower()
            if spoken in descriptors:
                both = f"{descriptors[spoken]!r} and {name!r}"
                message = f"objects {both} are both called {item.prompt_name!r} in prompts"
                self._sheet.report(("objects", name), f"{message}; give them descriptors that tell them apart")
            elif item.prompt_name != name and item.prompt_name in self._objects:
                message = (
                    f"object {name!r} is called {item.prompt_name!r} in prompts, which is the name of another object"
                )
                self._sheet.report(("objects", name), f"{message}; change its descriptor")
            descriptors[spoken] = name
        return tuple(self._objects.values())

    def _list_object(self, loc: Loc, name: str) -> None:
        if name in self._objects:
            self._sheet.report(loc, f"object {name!r} is listed twice")
        elif name in self._declared.objects:
            self._objects[name] = self._declared.objects[name]
        elif name not in self._broken:
            known = self._declared.objects
            message = f"{UnknownNameError('object', name, known)}; declare it under 'objects' in domain.yaml"
            self._sheet.report(loc, message)
            self._broken.add(name)

    def atoms(self, loc: Loc, texts: Sequence[str], first: int = 0) -> tuple[Atom, ...]:
        """The atoms written as ``On(a, b)``, in the order written; ``first`` is the number of the first entry."""
        atoms = []
        for i, text in enumerate(texts, start=first):
            if is_unfilled(text):
                signatures = [p.signature for p in self._names.predicates.values()]
                self._sheet.report((*loc, i), ask_for_atom(str(loc[-1]), signatures))
                continue
            try:
                written = _parse(text)
                if not self._is_broken(written):
                    atoms.append(self._atom(written))
            except ValueError as error:
                self._sheet.report((*loc, i), str(error))
        return tuple(atoms)

    def goals(self, loc: Loc, texts: Sequence[str]) -> tuple[tuple[Atom, ...], ...]:
        """The conjunctions of which one is to be reached; a text may be ``not``, ``and`` and ``or`` of atoms."""
        parts: list[list[tuple[Literal, ...]]] = []
        for i, text in enumerate(texts):
            if not _WORDS.search(text):
                parts += [
                    [((Application(a.predicate.name, tuple(o.name for o in a.objects)), True),)]
                    for a in self.atoms(loc, [text], i)
                ]
                continue
            try:
                part = parse_goal(text)
                if not any(self._is_broken(written) for literals in part for written, _ in literals):
                    combined([part], self._atom)
                    parts.append(part)
            except ValueError as error:
                self._sheet.report((*loc, i), str(error))
        try:
            return combined(parts, self._atom)
        except ValueError as error:
            self._sheet.report(loc, str(error))
            return ()

    def _atom(self, written: Application) -> Atom:
        return self._names.atom(written.name, written.args, self._objects)

    def actions(self, loc: Loc, texts: Sequence[str]) -> tuple[Action, ...]:
        """The actions written as ``Push(a, b)[0.1, -0.2]``; behind those that failed stands ``failed``."""
        actions = []
        for i, text in enumerate(texts):
            if is_unfilled(text):
                self._sheet.report((*loc, i), ask_for_action(i, self._names.skills.values()))
                continue
            try:
                done, failed = _split_failed(text)
                head, params = _split_params(done)
                written = _parse(head)
                if not self._is_broken(written):
                    action = self._names.action(written.name, written.args, params, self._objects)
                    _check_params(action)
                    actions.append(replace(action, failed=failed))
            except ValueError as error:
                self._sheet.report((*loc, i), str(error))
        return tuple(actions)

    def _is_broken(self, written: Application) -> bool:
        """Whether the text uses a name that is already reported."""
        broken = not self._broken.isdisjoint((written.name, *written.args))
        self.incomplete |= broken
        return broken

    def state(self, loc: Loc, doc: StateDoc, images: Path) -> State:
        """The state at ``loc``, whose pictures lie in the folder ``images``."""
        return State(
            self._pictures(loc, doc, images),
            self._state_features(loc, doc.features),
            frozenset(self.atoms((*loc, "given"), doc.given)),
        )

    def _state_features(self, loc: Loc, features: Mapping[str, tuple[float, ...]]) -> dict[Object, tuple[float, ...]]:
        values = {}
        for name, vector in features.items():
            here = (*loc, "features", name)
            item = self._objects.get(name)
            if item is None:
                self._report_object(here, name)
            elif len(vector) != len(item.type.features):
                wanted = f"[{', '.join(item.type.features)}]"
                self._sheet.report(here, f"a {item.type} has the features {wanted}, found {len(vector)} values")
            else:
                values[item] = vector
        if self._features is None:
            self._features = bool(features)
        missing = [o.name for o in self._objects.values() if o.type.features and o.name not in features]
        if bool(features) != self._features:
            self._sheet.report((*loc, "features"), "features must be given in every state or in none")
        elif features and missing:
            self._sheet.report((*loc, "features"), f"features are missing for {', '.join(missing)}")
        return values

    def _report_object(self, loc: Loc, name: str) -> None:
        if name not in self._broken:
            self._sheet.report(loc, str(UnknownNameError("object", name, self._objects)))

    def _pictures(self, loc: Loc, doc: StateDoc, images: Path) -> tuple[Picture, ...]:
        wanted = None if doc.pictures is None else tuple(doc.pictures)
        paths = find_pictures(images, wanted, self._sheet, loc, self._root)
        cameras = tuple(paths) if wanted is None else wanted
        if self._cameras is None:
            self._cameras = cameras
        elif set(cameras) != set(self._cameras):
            first, here = (", ".join(c) or "none" for c in (self._cameras, cameras))
            message = f"the cameras of this state are {here}, those of the first state {first}; use the same in all"
            self._sheet.report((*loc, "pictures"), message)
        pictures = []
        for camera in (c for c in self._cameras if c in paths):
            boxes = self.boxes((*loc, "pictures", camera), (doc.pictures or {}).get(camera, {}))
            pictures.append(Picture(camera, Image(paths[camera]), boxes))
        if self._check is not None:
            self._check.look({p.camera: Shown(paths[p.camera], p.image, p.boxes) for p in pictures}, loc)
        return tuple(pictures)

    def boxes(self, loc: Loc, docs: Mapping[str, tuple[float, ...]]) -> dict[str, Box]:
        """The boxes of the file's entry ``docs`` at ``loc``, by object."""
        boxes = {}
        for name, (left, top, right, bottom) in docs.items():
            if name not in self._objects:
                self._report_object((*loc, name), name)
            elif left >= right or top >= bottom:
                self._sheet.report(
                    (*loc, name), f"the box of {name!r} is empty or inverted: [left, top, right, bottom] needs left < "
                    "right and top < bottom",
                )  # fmt: skip
            else:
                boxes[name] = Box(left, top, right, bottom)
        return boxes


def _parse(text: str) -> Application:
    try:
        return parse_application(text)
    except ValueError as error:
        cut = text.count("(") != text.count(")")
        hint = "; inside [ ] each entry with a comma needs quotes, or write one entry a line" if cut else ""
        raise ValueError(f"{error}{hint}") from None


def _split_failed(text: str) -> tuple[str, bool]:
    """An action without the word behind it that says it failed, and whether there was one."""
    head, _, last = text.rstrip().rpartition(" ")
    return (head, True) if last.strip("()").lower() == FAILED and head else (text, False)


def _split_params(text: str) -> tuple[str, tuple[float, ...]]:
    """``Push(a)[0.1, 2]`` as ``Push(a)`` and its numbers; they may stand inside, as in ``push(a, [0.1, 2])``."""
    if inside := _INSIDE.match(text):
        text = f"{inside[1]}){inside[2]}"
    head, bracket, tail = text.partition("[")
    if not bracket:
        return text, ()
    if not tail.rstrip().endswith("]"):
        raise ValueError(f"']' is missing at the end of {text!r}")
    inner = tail.rstrip()[:-1].strip()
    try:
        params = tuple(float(part) for part in inner.split(",")) if inner else ()
    except ValueError:
        raise ValueError(f"expected numbers between '[' and ']' in {text!r}") from None
    if not all(math.isfinite(p) for p in params):
        raise ValueError(f"parameters must be finite numbers in {text!r}")
    return head, params


def _check_params(action: Action) -> None:
    for i, (low, value, high) in enumerate(zip(action.skill.low, action.params, action.skill.high, strict=True)):
        if not low <= value <= high:
            raise ValueError(f"parameter {i} of skill {action.skill.name} is {value}, outside [{low}, {high}]")
