"""Demonstrations on their way in: pictures and what is known, the rest marked for a person to fill in."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pix2pred.demos.declared import Declared, build_declared
from pix2pred.demos.files.documents import VERSION, DemoDoc, DomainDoc, load_document
from pix2pred.demos.files.folders import DEMO, DEMOS, DOMAIN, IMAGES, is_folder
from pix2pred.demos.files.problems import FolderError, Problem
from pix2pred.demos.files.schemas import SCHEMAS, schema_line, write_schemas
from pix2pred.demos.files.staging import move_in, staged
from pix2pred.demos.files.unfilled import UNFILLED
from pix2pred.demos.files.yaml_text import inline_yaml
from pix2pred.demos.pictures import JPEG_START
from pix2pred.structs import FromHuman, Image
from pix2pred.structs.formats.documents import ObjectDoc

Told = Callable[[str, int, int], None]
"""Called with the name of a demonstration, the number of states written and the number of all."""


@dataclass(frozen=True, slots=True)
class Draft:
    """A demonstration that is brought in.

    ``states`` gives the pictures of each of the ``len(actions) + 1`` states by camera, and is gone through once.
    An action of None is to be filled in, like an empty ``goal``; without ``objects``, all that are declared are listed.
    ``notes`` go into the file as comments. ``given`` are the atoms that hold in each state, where somebody listed them.
    """

    name: str
    actions: tuple[str | None, ...]
    states: Iterable[Mapping[str, Image]]
    objects: Sequence[str] | Mapping[str, ObjectDoc] = ()
    goal: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    given: tuple[tuple[str, ...], ...] = ()


def _quiet(name: str, done: int, total: int) -> None:
    pass


def write_drafts(
    directory: Path, drafts: Sequence[Draft], domain: str | None = None, *, overwrite: bool = False, tell: Told = _quiet
) -> None:
    """Write ``drafts``, all or none, into the project at ``directory``.

    A project that is there gets them added. With ``domain``, the text of a ``domain.yaml``, a new project is begun
    instead. Nothing that exists is replaced unless ``overwrite`` says so. Raises ``FolderError``.
    """
    directory = directory.absolute()
    if domain is not None:
        refuse_begun(directory, overwrite=overwrite)
    else:
        _refuse_present(directory, drafts, overwrite=overwrite)
    with staged(directory) as stage:
        if domain is not None:
            (stage / DOMAIN).write_text(schema_line("domain") + domain, encoding="utf-8", newline="\n")
            write_schemas(stage / SCHEMAS)
        declared = _declared(stage if domain is not None else directory)
        found: list[Problem] = []
        for draft in drafts:
            try:
                _write_draft(stage / DEMOS / draft.name, draft, declared, tell)
            except FolderError as error:
                found += error.problems
        if found:
            raise FolderError(found)
        if domain is not None:
            (stage / DEMOS).mkdir(exist_ok=True)
            move_in(stage, directory, [DOMAIN, DEMOS, SCHEMAS])
        else:
            (directory / DEMOS).mkdir(exist_ok=True)
            move_in(stage / DEMOS, directory / DEMOS, [draft.name for draft in drafts])


def refuse_begun(directory: Path, *, overwrite: bool) -> None:
    """Raise ``FolderError`` where a new project would replace something, unless ``overwrite`` says so."""
    if (directory.exists() or directory.is_symlink()) and not is_folder(directory):
        raise FolderError.about(directory, "is no folder; choose another place")
    if overwrite:
        return
    message = "exists already; choose another folder, or say --overwrite to replace it"
    present = [directory / name for name in (DOMAIN, DEMOS, SCHEMAS) if (directory / name).exists()]
    if present:
        raise FolderError([Problem(path, None, message) for path in present])


def _refuse_present(directory: Path, drafts: Sequence[Draft], *, overwrite: bool) -> None:
    if not is_folder(directory) or not (directory / DOMAIN).exists():
        raise FolderError.about(directory / DOMAIN, "there is no project yet; begin one with: pix2pred init")
    present = {path.name.casefold(): path for path in _entries(directory / DEMOS)}
    found = []
    for draft in drafts:
        path = present.get(draft.name.casefold())
        if path is not None and not (overwrite and path.name == draft.name):
            message = "exists already; give the demonstration another name, or say --overwrite"
            found.append(Problem(path, None, message))
    if found:
        raise FolderError(found)


def _entries(folder: Path) -> list[Path]:
    return list(folder.iterdir()) if is_folder(folder) else []


def _declared(directory: Path) -> Declared:
    """What is declared so far, sound or not: what is wrong with it is for ``check`` to say."""
    found: list[Problem] = []
    loaded = load_document(directory / DOMAIN, directory, DomainDoc, found)
    if loaded is None:
        raise FolderError(found)
    return build_declared(*loaded)


def _write_draft(folder: Path, draft: Draft, declared: Declared, tell: Told) -> None:
    total = len(draft.actions) + 1
    written = 0
    for t, pictures in enumerate(draft.states):
        images = folder / IMAGES / str(t)
        images.mkdir(parents=True)
        for camera, image in pictures.items():
            encoded = image.encoded
            (images / f"{camera}{'.jpg' if encoded.startswith(JPEG_START) else '.png'}").write_bytes(encoded)
        written += 1
        tell(draft.name, written, total)
    assert written in (0, total), f"{draft.name}: {written} states around {total - 1} actions"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / DEMO).write_text(draft_text(draft, declared), encoding="utf-8", newline="\n")


def draft_text(draft: Draft, declared: Declared) -> str:
    """The ``demo.yaml`` of ``draft``, with comments that say what goes where."""
    skills = ", ".join(map(str, declared.vocabulary.skills)) or "declare them in domain.yaml"
    atoms = ", ".join(p.signature for p in declared.vocabulary.initial) or "declare predicates in domain.yaml"
    goal = draft.goal or (UNFILLED,)
    total = len(draft.actions) + 1
    lines = [
        *(_comment(note) for note in draft.notes),
        f"format: {DemoDoc.FORMAT}",
        f"version: {VERSION}",
        "",
        *_objects(draft, declared),
        "",
        _comment(f"What holds in the last state, and not before. Initial predicates: {atoms}"),
        "goal:",
        *(f"- {inline_yaml(atom)}" for atom in goal),
        "",
        _comment(f"One line for each step from one state to the next. Skills: {skills}"),
        "actions:",
        *(
            f"- {inline_yaml(action or UNFILLED)}  # images/{t} -> images/{t + 1}"
            for t, action in enumerate(draft.actions)
        ),
        "",
        _comment(
            "The pictures of state t are images/t/<camera>.jpg or .png. Atoms of the source human that hold there"
        ),
        _comment(
            "are listed as 'given'; boxes of objects can be given too: pictures: {main: {cup: [12, 40, 90, 130]}}"
        ),
        "states:",
        *(f"- given: {_given(draft, declared, t)}  # images/{t}" for t in range(total)),
    ]
    return schema_line("demo", "../../") + "".join(f"{line}\n" for line in lines)


def _given(draft: Draft, declared: Declared, t: int) -> str:
    """What stands where atoms of the source human are listed: nothing is listed is not the same as nothing holds."""
    if draft.given:
        return inline_yaml([*draft.given[t]])
    asks = any(isinstance(p.source, FromHuman) for p in declared.vocabulary.initial)
    return f"[{UNFILLED}]" if asks else "[]"


def _objects(draft: Draft, declared: Declared) -> list[str]:
    if isinstance(draft.objects, Mapping):
        rows = [
            f"  {inline_yaml(name)}: {inline_yaml({'type': doc.type, 'descriptor': doc.descriptor or name})}"
            for name, doc in draft.objects.items()
        ]
        return ["objects:", *rows]
    names = [*draft.objects] or [*declared.objects]
    return [
        _comment("The objects in the pictures, of those that domain.yaml declares."),
        f"objects: {inline_yaml(names)}",
    ]


def _comment(text: str) -> str:
    """``text`` as one line that nothing in it can end."""
    plain = "".join(c if c.isprintable() else " " for c in text)
    return f"# {plain}"
