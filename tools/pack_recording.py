"""Makes a shipped recording from a project and the answers that a model gave to all questions about it.

    python tools/pack_recording.py kitchen --data DATA --answers STORE

``src/pix2pred/recordings/NAME/recording.yaml`` and ``settings.yaml`` have to be there. Learning and
solving are replayed, and only answers that either of them needed are packed. The project folder is packed with
``--with-data``, for pictures that another machine would draw differently; otherwise it is drawn again by whoever
replays the answers.
"""

from __future__ import annotations

import argparse
import io
import lzma
import tarfile
from collections.abc import Iterable
from pathlib import Path

import PIL.Image

from pix2pred.demos import read_project, read_tasks
from pix2pred.execution import Solver
from pix2pred.pipeline import LearningProblem, learn
from pix2pred.predicates import Labeller
from pix2pred.recordings.recording import ANSWERS, DATA, load_recording
from pix2pred.registry import REGISTRY
from pix2pred.settings import of_file, of_project, resolve
from pix2pred.system.files import write_whole
from pix2pred.vlm import Answer, AnswerStore, Request, StoredVLM, StoreMode
from pix2pred.vlm.answers.replay import replayed

PRESET = 9 | lzma.PRESET_EXTREME
"""LZMA's largest dictionary (64 MiB): a repeated background is found whatever lies between its two pictures."""


def pack_folder(folder: Path, names: Iterable[str], archive: Path) -> None:
    """Write the files ``names`` of ``folder`` into ``archive``, without dates or owners: equal files, equal bytes."""
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w", format=tarfile.USTAR_FORMAT) as tar:
        for name in sorted(names):
            content = (folder / name).read_bytes()
            if name.endswith(".png"):
                content = _stored_plainly(content)
            entry = tarfile.TarInfo(name)
            entry.size = len(content)
            tar.addfile(entry, io.BytesIO(content))
    write_whole(archive, lzma.compress(packed.getvalue(), preset=PRESET))


def _stored_plainly(png: bytes) -> bytes:
    plain = io.BytesIO()
    PIL.Image.open(io.BytesIO(png)).convert("RGB").save(plain, "PNG", compress_level=0)
    return plain.getvalue()


class Noting:
    """A replayed model that notes the keys of the questions it was asked."""

    def __init__(self, store: AnswerStore) -> None:
        self._replayed = StoredVLM(replayed(store), store, StoreMode.REPLAY)
        self.name = self._replayed.name
        self.keys: set[str] = set()

    def answer(self, request: Request) -> Answer:
        self.keys.add(request.key(self.name))
        return self._replayed.answer(request)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name")
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--answers", type=Path, required=True)
    parser.add_argument("--with-data", action="store_true")
    arguments = parser.parse_args()
    recording = load_recording(arguments.name)
    project = read_project(arguments.data)
    settings = resolve(of_project(project.sections), *([of_file(recording.settings)] if recording.settings else []))
    store = AnswerStore(arguments.answers)
    model = Noting(store)
    learned = learn(LearningProblem(project.vocabulary, project.demos, model, settings))
    solver = Solver(learned.model, REGISTRY.planner("portfolio"), Labeller(model, settings.labels))
    for stored in read_tasks(arguments.data, project.vocabulary):
        _, found = solver.plan(stored.task)
        print(stored.task.name, found.status, len(found.plan))
    names = [str(store.path(key).relative_to(store.directory)) for key in model.keys]
    pack_folder(store.directory, names, recording.folder / ANSWERS)
    if arguments.with_data:
        files = [p.relative_to(arguments.data).as_posix() for p in arguments.data.rglob("*") if p.is_file()]
        pack_folder(arguments.data, files, recording.folder / DATA)
    print(*(f"{p.name}: {p.stat().st_size:,} bytes" for p in sorted(recording.folder.glob("*.xz"))), sep="\n")


if __name__ == "__main__":
    main()
