"""A recorded model: where the pictures it was shown come from, its answers, and what they prove.

A recording is a folder of this package:

    recording.yaml     where its demonstrations come from, what it shows and does not
    settings.yaml      the settings of the run, as a --config file
    answers.tar.xz     every answer that learning and solving need, as an answer store
    data.tar.xz        the project folder, where the pictures depend on the machine that draws them
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import yaml
from pydantic import Field

from pix2pred.recordings.archive import unpack_folder
from pix2pred.structs.formats.documents import Document
from pix2pred.structs.formats.names import UnknownNameError

ROOT = Path(__file__).parent
ANSWERS, DATA, DESCRIPTION, SETTINGS = "answers.tar.xz", "data.tar.xz", "recording.yaml", "settings.yaml"


class RecordingDoc(Document):
    """The file ``recording.yaml``.

    ``seed`` draws the demonstrations and tasks where no project folder comes along. ``shows`` and ``does_not_show``
    have to be told together with any result.
    """

    format: Literal["pix2pred-recording"]
    version: Literal[1]
    domain: str
    family: str
    seed: int = Field(ge=0)
    tasks: int = Field(ge=1)
    model: str
    recorded: str
    shows: tuple[str, ...]
    does_not_show: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Recording:
    """A recorded model's answers. ``name`` is what the command line calls it."""

    name: str
    folder: Path
    about: RecordingDoc

    @property
    def settings(self) -> Path:
        """The file of settings with which the model was asked."""
        return self.folder / SETTINGS

    @property
    def brings_data(self) -> bool:
        """Whether the project folder comes along; otherwise it is drawn, and equal on every machine."""
        return (self.folder / DATA).exists()

    def unpack_answers(self, folder: Path) -> None:
        """Write the answer store into ``folder``."""
        unpack_folder(self.folder / ANSWERS, folder)

    def unpack_data(self, folder: Path) -> None:
        """Write the project folder into ``folder``; only where ``brings_data``."""
        unpack_folder(self.folder / DATA, folder)


def recording_names(root: Path = ROOT) -> tuple[str, ...]:
    """The recordings that there are, sorted."""
    return tuple(sorted(path.parent.name for path in root.glob(f"*/{DESCRIPTION}")))


def load_recording(name: str, root: Path = ROOT) -> Recording:
    """The recording called ``name``. Raises ``UnknownNameError``."""
    names = recording_names(root)
    if name not in names:
        raise UnknownNameError("recording", name, names)
    text = (root / name / DESCRIPTION).read_text(encoding="utf-8")
    return Recording(name, root / name, RecordingDoc.model_validate(yaml.safe_load(text)))
