"""Filling in the prompt texts: how objects, actions and atoms are written for a model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib.resources import files
from itertools import islice
from string import Template

from pix2pred.structs import Action, Atom, FromVLM, Object, Picture, Predicate, State, Type
from pix2pred.structs.skills import FAILED
from pix2pred.structs.views import LONGEST_SIDE, View


def fill(prompt: str, room: str = "pix2pred.predicates", /, **values: str) -> str:
    """The prompt ``prompts/<prompt>.txt`` of ``room`` with its ``$fields`` replaced, without the comment on top."""
    return _template(room, prompt).substitute(values)


@cache
def _template(room: str, name: str) -> Template:
    text = (files(room) / "prompts" / f"{name}.txt").read_text(encoding="utf-8")
    comment, _, body = text.partition("\n")
    assert comment.startswith("# Method"), f"prompt {name} names the section it implements"
    return Template(body)


def object_lines(objects: Iterable[Object]) -> str:
    """One line per object: name and type."""
    return "\n".join(f"- {o.prompt_name} ({o.type.name})" for o in sorted(objects, key=lambda o: o.prompt_name))


def kind_lines(objects: Iterable[Object]) -> str:
    """Which types are kinds of a more general one, for types that words may use, and what types are said to be.

    Empty where there is neither.
    """
    kinds: dict[Type, set[str]] = {}
    for one in {o.type for o in objects}:
        kinds.setdefault(one, set())
        for general in islice(one.lineage, 1, None):
            kinds.setdefault(general, set()).add(one.name)
    in_order = sorted(kinds, key=lambda t: t.name)
    lines = [f"- {kind.name}: {', '.join(sorted(kinds[kind]))}" for kind in in_order if kinds[kind]]
    return titled("More general types, and what belongs to each:", lines) + type_meanings(in_order)


def type_meanings(types: Iterable[Type]) -> str:
    """What ``types`` are said to be, one a line, in their order; empty where nothing is said."""
    return titled("What types mean:", [f"- {kind.name} = {kind.description}" for kind in types if kind.description])


def titled(title: str, lines: Sequence[str]) -> str:
    """A paragraph between blank lines; empty where there are no lines."""
    return "\n".join(["", title, *lines, ""]) if lines else ""


def action_text(action: Action) -> str:
    """``Skill[obj:type, obj:type]``, and whether it failed."""
    text = f"{action.skill.name}[{', '.join(f'{o.prompt_name}:{o.type.name}' for o in action.objects)}]"
    return f"{text} ({FAILED})" if action.failed else text


def atom_text(atom: Atom) -> str:
    """``phrase(obj1, obj2)``: queries use the base name, without the number that makes names unique."""
    source = atom.predicate.source
    phrase = source.phrase if isinstance(source, FromVLM) else atom.predicate.name
    return f"{phrase}({', '.join(o.prompt_name for o in atom.objects)})"


def meaning_lines(predicates: Iterable[Predicate]) -> str:
    """One line per word: its types, its meaning, and whether it never changes.

    A word that is used for several types with the same meaning has one line.
    """
    lines: dict[tuple[str, int, str], list[str]] = {}
    for predicate in sorted(predicates):
        source = predicate.source
        word = source.phrase if isinstance(source, FromVLM) else predicate.name
        stays = isinstance(source, FromVLM) and not source.changes
        says = (predicate.description or "as the word says") + (" It never changes." if stays else "")
        lines.setdefault((word, predicate.arity, says), []).append(f"({', '.join(t.name for t in predicate.types)})")
    return "\n".join(f"- {word}{', '.join(types)}: {says}" for (word, _, says), types in lines.items())


def views(
    state: State,
    t: int,
    objects: Iterable[Object],
    *,
    marks: bool,
    longest_side: int = LONGEST_SIDE,
    label: str = "",
    after: int | None = None,
) -> tuple[View, ...]:
    """All cameras of a state, with headings such as ``state 3, camera main``.

    ``after`` is the number of the skill that led to the state, where the heading is to name it.
    """
    names = {o.name: o.prompt_name for o in objects}
    shown = [_renamed(p, names) for p in state.pictures]
    prefix = f"{label}: " if label else ""
    heading = f"{prefix}state {t}{'' if after is None else f' after skill {after}'}, camera"
    return tuple(
        View(
            p, t, marks=marks, heading=f"{heading} {p.camera}", longest_side=longest_side,
            unseen=tuple(sorted({*names.values()} - {*p.boxes})) if marks and p.boxes else (),
        )
        for p in shown
    )  # fmt: skip


def _renamed(picture: Picture, names: Mapping[str, str]) -> Picture:
    """The picture with boxes of the task's objects only, under the names the prompt uses."""
    boxes = {names[name]: box for name, box in picture.boxes.items() if name in names}
    return Picture(picture.camera, picture.image, boxes)
