"""From the labels of a run to a reader's folder, and again when more has been labelled since."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pix2pred.runs import addresses
from pix2pred.runs.distilling.demonstrations import TeachingMaterial, taught_by_demonstrations
from pix2pred.runs.distilling.episodes import add_episodes
from pix2pred.runs.distilling.pictures import Stores
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.system.files import write_whole
from pix2pred.system.progress import Progress, silent
from pix2pred.vlm import AnswerStore
from pix2pred.vlm.distilled.files import CARD, CardDoc, MadeFrom, ReaderFileError, write_reader
from pix2pred.vlm.distilled.fitting.fit import fit
from pix2pred.vlm.distilled.fitting.lesson import FitSettings, Lesson, LessonError

SOURCES = "sources.json"
"""In a reader's folder: what it was made from, as paths relative to it, for ``distil --resume``."""


@dataclass(frozen=True, slots=True)
class ReaderSources:
    """A run, folders with answers of more episodes, and how a reader is to be made of them."""

    run: Path
    episodes: tuple[Path, ...] = ()
    everything: bool = False
    settings: FitSettings = field(default_factory=FitSettings)

    def extended(self, episodes: Sequence[Path]) -> ReaderSources:
        """With more folders of episodes."""
        known = {folder.resolve() for folder in self.episodes}
        new = [folder for folder in episodes if folder.resolve() not in known]
        return ReaderSources(self.run, (*self.episodes, *new), self.everything, self.settings)


def distil(sources: ReaderSources, out: Path, progress: Progress = silent) -> CardDoc:
    """Make a reader in ``out``; gives its card.

    Raises ``RunFolderError`` for a run that was not finished, and ``LessonError`` when nothing can be learned.
    """
    run = RunFolder(sources.run)
    config = run.config()
    if (out / CARD).exists() is False and out.is_dir() and any(out.iterdir()):
        raise ReaderFileError(f"{out}: is not empty and holds no reader; name another folder with --out")
    teacher = str(config.get("model", ""))
    own = [AnswerStore(folder) for folder in addresses.stores_of_pictures(run.path, config)]
    others = [_answers_of(folder) for folder in sources.episodes]
    stores = Stores([*own, *others])
    found = taught_by_demonstrations(run, stores, everything=sources.everything)
    if not found.predicates:
        raise LessonError(
            f"{run.path}: no predicate of its world model is read from pictures, so there is nothing to teach; learn "
            "with the setting grammar.max_candidates: 0 for one that is, or teach the words of the pool with --all"
        )
    for store in own:
        add_episodes(found, store, teacher, stores)
    for folder, store in zip(sources.episodes, others, strict=True):
        if not add_episodes(found, store, teacher, stores):
            raise LessonError(
                f"{folder}: holds no labels of {teacher} about states that the run does not know already; name a run "
                "folder or an answer store in which tasks were solved with that model"
            )
    if not found.looks and found.lost:
        raise LessonError(f"{run.path}: none of its {found.lost} labelled states has a picture in its answer stores")
    lesson = Lesson(found.looks, found.groups, found.examples)
    fitted = fit(lesson, sources.settings, progress)
    card = write_reader(out, fitted, _made_from(found, teacher), sources.settings.model_dump())
    write_whole(out / SOURCES, (json.dumps(_sources_doc(sources, out), indent=1) + "\n").encode())
    return card


def _answers_of(folder: Path) -> AnswerStore:
    """The answer store of a run folder, or the one that a folder is."""
    if (folder / "config.yaml").is_file():
        answers = RunFolder(folder).config().get("answers")
        return AnswerStore(Path(str(answers)) if answers else folder)
    if not (folder / "answers").is_dir():
        raise RunFolderError(f"{folder}: is neither a run folder nor an answer store")
    return AnswerStore(folder)


def _made_from(found: TeachingMaterial, teacher: str) -> MadeFrom:
    digest = hashlib.sha256()
    for group, pictures in zip(found.groups, found.digests, strict=True):
        digest.update(json.dumps([group, *pictures]).encode())
    for e in found.examples:
        digest.update(json.dumps([e.look, e.word, e.names, e.label, round(e.weight, 6)]).encode())
    return MadeFrom(
        teacher=teacher, vocabulary=found.model.vocabulary.name, demonstrations=found.demonstrations,
        episodes=found.episodes, looks=len(found.looks), labels=len(found.examples), corrected=found.corrected,
        doubted=found.doubted, data=digest.hexdigest(),
    )  # fmt: skip


def _sources_doc(sources: ReaderSources, out: Path) -> dict[str, Any]:
    def relative(path: Path) -> str:
        return Path(os.path.relpath(path.resolve(), out.resolve())).as_posix()

    return {
        "format": "pix2pred-distilled-sources",
        "version": 1,
        "run": relative(sources.run),
        "episodes": [relative(folder) for folder in sources.episodes],
        "everything": sources.everything,
        "settings": sources.settings.model_dump(),
    }


def load_sources(reader: Path) -> ReaderSources:
    """What a reader was made from. Raises ``ReaderFileError`` for a folder that does not say."""
    path = reader / SOURCES
    try:
        doc = json.loads(path.read_text(encoding="utf-8"))
        return ReaderSources(
            reader / doc["run"],
            tuple(reader / folder for folder in doc["episodes"]),
            bool(doc["everything"]),
            FitSettings.model_validate(doc["settings"]),
        )
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ReaderFileError(
            f"{path}: does not say what the reader was made from ({error}); distil from the run with --out"
        ) from error
