"""The conversation of ``plan --interactive``: name the skill, wait for the photo, say what differs."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from pix2pred.cli.console import err, out, plain, say
from pix2pred.demos import ENDINGS, FolderError, Photographed, read_photo
from pix2pred.execution import Guided, Missing, PlannedScene, SeenStep
from pix2pred.execution.explaining.wording import in_words
from pix2pred.images import nearly_same
from pix2pred.report.plan_page import render_plan
from pix2pred.runs.plan_folder import PAGE, PlanFolder, SessionDoc
from pix2pred.structs import Atom, FromSkills
from pix2pred.structs.plans import Change, effects, signed

POLL = 0.3
"""Seconds between two looks into a watched folder; a file that is the same in both is taken for complete."""


class Photos(Protocol):
    """Where photos come from."""

    def next(self) -> Path | None:
        """The photo after the skill that was just named, as soon as there is one; None: nobody will bring any more."""
        ...

    def confirmed(self, changes: tuple[Change, ...]) -> tuple[Change, ...] | None:
        """Of ``changes`` that no photo shows, those that did happen; None when nobody can be asked."""
        ...

    def done_unseen(self) -> bool:
        """Whether the skill was executed although the photo shows what the one before showed."""
        ...

    def may_assume(self, atoms: Sequence[Atom]) -> bool:
        """Whether to try the only plan there is, which works if ``atoms`` hold although they look otherwise."""
        ...


class TypedPaths:
    """A person at the terminal types the path of each photo."""

    def next(self) -> Path | None:
        """Ask for a path until there is one; the end of the input stops."""
        while True:
            line = _ask("photo after it: ")
            if line is None:
                return None
            if line:
                return Path(line).expanduser()

    def confirmed(self, changes: tuple[Change, ...]) -> tuple[Change, ...] | None:
        """Ask; an empty line says that all of them happened."""
        out.print(plain(f"     no photo shows: {' '.join(signed(changes))}"), markup=False, soft_wrap=True)
        line = _ask("did this happen (Enter: yes, n: nothing of it)? ")
        return None if line is None else () if line.lower().startswith("n") else changes

    def done_unseen(self) -> bool:
        line = _ask("was it executed all the same (y: yes, Enter: no, I take another photo)? ")
        return line is not None and line.lower().startswith("y")

    def may_assume(self, atoms: Sequence[Atom]) -> bool:
        say_assumed(atoms)
        line = _ask("try that plan (y: yes, Enter: no)? ")
        return line is not None and line.lower().startswith("y")


class WatchedFolder:
    """Photos that appear in a folder, oldest first; those used already are known from the session."""

    def __init__(self, folder: Path, session: SessionDoc) -> None:
        if not folder.is_dir():
            raise FolderError.about(folder, "is not a folder; make it, and put the photos there")
        self._folder = folder
        self._used = {entry.photo for entry in session.executed}

    def next(self) -> Path | None:
        """Wait for a picture, or a folder of pictures, that was not used and has stopped changing."""
        err.print(f"waiting for a photo in {self._folder}; Ctrl-C stops", markup=False, style="dim")
        seen: dict[Path, tuple[tuple[int, int], ...]] = {}
        while True:
            now = {path: _state(path) for path in self._folder.iterdir() if self._is_new(path)}
            ready = sorted((now[p], p.name, p) for p in now if now[p] and seen.get(p) == now[p])
            if ready:
                self._used.add(ready[0][2].name)
                return ready[0][2]
            seen = now
            time.sleep(POLL)

    def _is_new(self, path: Path) -> bool:
        named = not path.name.startswith(".") and path.name not in self._used
        return named and (path.is_dir() or path.suffix.lower() in ENDINGS)

    def confirmed(self, changes: tuple[Change, ...]) -> None:
        """Nobody can be asked: the YAML file beside a photo may tell."""

    def done_unseen(self) -> bool:
        say("     taken for not executed; a YAML file beside the photo that lists 'given' says otherwise")
        return False

    def may_assume(self, atoms: Sequence[Atom]) -> bool:
        say_assumed(atoms)
        say("     nobody can be asked here: the same command with --interactive and without --photos asks")
        return False


def say_assumed(atoms: Sequence[Atom]) -> None:
    """That the only plan there is rests on ``atoms``, which do not seem to hold."""
    held = ", ".join(map(str, atoms))
    out.print(plain(f"     no plan from what is seen; there is one if these hold all the same: {held}"), markup=False)


def _state(path: Path) -> tuple[tuple[int, int], ...]:
    """Times and sizes of the pictures at ``path``."""
    files = [p for p in path.iterdir() if p.suffix.lower() in ENDINGS] if path.is_dir() else [path]
    return tuple(sorted((f.stat().st_mtime_ns, f.stat().st_size) for f in files))


def _ask(question: str) -> str | None:
    print(question, end="", flush=True, file=sys.stderr)
    line = sys.stdin.readline()
    return line.strip() if line else None


def guide(folder: PlanFolder, session: SessionDoc, scene: PlannedScene, photos: Photos | None) -> Guided:
    """Execute a plan with a person; everything is on disk before the next skill is named.

    Without ``photos`` nothing more is executed: what was, is taken up again and written.
    """
    taken_up: list[SeenStep] = []

    def may_assume(atoms: Sequence[Atom]) -> bool:
        """What the person said: of steps that are taken up again, that there is a next one shows it."""
        return len(taken_up) + 1 < len(session.executed) or (photos is not None and photos.may_assume(atoms))

    guided = Guided(scene, may_assume=may_assume)
    for look in folder.replay(session, guided):
        taken_up.append(look)
        if photos is not None:
            _say(guided, look, known=True)
    if photos is None:
        _save(folder, scene, guided)
        return guided
    while guided.step is not None:
        _save(folder, scene, guided)
        number = len(guided.looks) + 1
        expected = " ".join(signed(effects(guided.step)))
        out.print(plain(f"\nstep {number}, {len(guided.remaining)} to go:  {in_words(guided.step)}"), markup=False)
        out.print(plain(f"     expected: {expected}"), markup=False, soft_wrap=True)
        photographed = _photograph(guided, photos)
        if photographed is None:
            out.print("\nstopped; the same command goes on from here")
            break
        path, seen = photographed
        session = folder.remember(session, guided, path, seen)
        taken_up = [*guided.looks]  # the step whose photo was just kept is asked about
        _say(guided, guided.observe(seen.state, told=seen.told))
    _save(folder, scene, guided)
    if guided.step is None:
        last = "the goal holds in the last photo" if guided.reached else f"stopped: {guided.ended}"
        hint = "" if guided.reached else "; --retake forgets the last photo"
        out.print(plain(f"\n{last}{hint}"), markup=False, soft_wrap=True)
        print_missing(guided.missing)
    return guided


def _photograph(guided: Guided, photos: Photos) -> tuple[Path, Photographed] | None:
    """The next photo that can be used, with what the person says about things no photo shows."""
    task, vocabulary = guided.scene.task, guided.scene.solver.model.vocabulary
    while (path := photos.next()) is not None:
        try:
            seen = read_photo(path, task, vocabulary)
        except FolderError as error:
            err.print(str(error), markup=False, style="red")
            continue
        if not seen.told and _nothing_happened(guided, seen) and not _done_unseen(guided, photos):
            continue
        if not seen.told and guided.expected_listed:
            changes = photos.confirmed(guided.expected_listed)
            if changes is not None:
                seen = Photographed(guided.told(seen.state, changes), told=True)
        return path, seen
    return None


def _nothing_happened(guided: Guided, seen: Photographed) -> bool:
    """Whether the photos show what those before the step showed."""
    before = guided.looks[-1].state if guided.looks else guided.scene.task.initial
    earlier = {p.camera: p.image.pixels() for p in before.pictures}
    return all(p.camera in earlier and nearly_same(p.image.pixels(), earlier[p.camera]) for p in seen.state.pictures)


def _done_unseen(guided: Guided, photos: Photos) -> bool:
    assert guided.step is not None, "there is a step"
    say("     this photo shows what the one before it showed: nothing seems to have happened")
    declared = [str(c) for c in effects(guided.step) if isinstance(c.atom.predicate.source, FromSkills)]
    if declared:
        out.print(plain(f"     would be taken for granted: {' '.join(declared)}"), markup=False, soft_wrap=True)
    return photos.done_unseen()


def _say(guided: Guided, look: SeenStep, *, known: bool = False) -> None:
    """How the last step went."""
    number = len(guided.looks)
    if known:
        out.print(plain(f"\nstep {number}, done before:  {in_words(look.step)}"), markup=False)
    if not look.absent and not look.surplus:
        out.print("     as expected")
    if look.absent:
        out.print(plain(f"     expected, not seen: {' '.join(signed(look.absent))}"), markup=False, soft_wrap=True)
    if look.surplus:
        out.print(plain(f"     seen, not expected: {' '.join(signed(look.surplus))}"), markup=False, soft_wrap=True)
    if look.assumed:
        out.print(plain(f"     taken for granted: {' '.join(signed(look.assumed))}"), markup=False, soft_wrap=True)
    if look.replanned and guided.step is not None:
        out.print(f"     planned again: {len(guided.remaining)} skills")
    elif look.absent and guided.step is not None:
        out.print("     the rest of the plan does not need it")


def print_missing(found: Sequence[Missing]) -> None:
    """Why there is no plan, a line per atom."""
    for m in found:
        lacks = ", ".join(str(a) for a in m.lacks)
        why = f"needs {m.step}, which lacks {lacks}" if m.step else "was not seen, and no learned operator adds it"
        out.print(plain(f"     {m.atom}: {why}"), markup=False, soft_wrap=True)


def _save(folder: PlanFolder, scene: PlannedScene, guided: Guided) -> None:
    folder.write_plan(scene, guided)
    folder.folder.write(PAGE, render_plan(scene, guided))
