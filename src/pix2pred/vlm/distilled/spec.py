"""``reader:DIR`` and ``cascade:READER,MODEL``: distilled readers as models that ``--vlm`` can name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from pix2pred.vlm.distilled.cascade import Cascade, SaidOf
from pix2pred.vlm.distilled.files import CardDoc, read_reader
from pix2pred.vlm.distilled.reader import DistilledReader
from pix2pred.vlm.model_spec import ModelNameError, ModelSpec, Rates, Setup
from pix2pred.vlm.request import VLM


@dataclass(frozen=True, slots=True)
class Free:
    """Rates of what runs here and costs nothing."""

    def picture_tokens(self, width: int, height: int) -> int:
        return 0

    def thinking_tokens(self) -> int:
        return 0

    def cached_tokens(self, repeated: int) -> int:
        return 0

    def dollars(self, input_tokens: int, output_tokens: int) -> float:
        return 0.0


@dataclass(frozen=True, slots=True)
class ReaderSpec(ModelSpec):
    """A distilled reader in a folder."""

    directory: Path

    def connect(self, setup: Setup) -> DistilledReader:
        """The reader. Raises ``ReaderFileError`` for a folder that holds none."""
        return DistilledReader(*read_reader(self.directory))

    @property
    def writes(self) -> bool:
        return False

    @property
    def rates(self) -> Rates:
        return Free()

    def known(self) -> str:
        _, card, digest = read_reader(self.directory)
        return f"{summary(card)} (reader {digest[:12]}); nothing was asked"


@dataclass(frozen=True, slots=True)
class CascadeSpec(ModelSpec):
    """A reader in front of another model."""

    reader: ReaderSpec
    model: ModelSpec
    said_of: SaidOf

    def connect(self, setup: Setup) -> VLM:
        return self.around(setup, lambda model: model.connect(setup))

    def around(self, setup: Setup, asked: Callable[[ModelSpec], VLM]) -> VLM:
        return Cascade(self.reader.connect(setup), asked(self.model), self.said_of)

    def known(self) -> str:
        return self.reader.known()

    @property
    def writes(self) -> bool:
        return self.model.writes

    @property
    def asks_the_rest(self) -> bool:
        return True

    @property
    def waits_in(self) -> Path | None:
        return self.model.waits_in

    @property
    def rates(self) -> Rates | None:
        return self.model.rates


def read_cascade(rest: str, named: Callable[[str], ModelSpec], said_of: SaidOf) -> CascadeSpec:
    """The cascade ``READER,MODEL``, whose large model is what ``named`` makes of the text after the first comma."""
    reader, comma, model = rest.partition(",")
    if not comma or not reader or not model:
        raise ModelNameError(
            f"--vlm cascade:{rest[:100]}: needs a reader's folder and a model: cascade:my-reader,openai:gpt-4o"
        )
    return CascadeSpec(ReaderSpec(Path(reader)), named(model), said_of)


def summary(card: CardDoc) -> str:
    """One sentence about a reader: its words, and how often it answers and is right on what was left out."""
    seen, answered = sum(w.seen for w in card.words), sum(w.answered for w in card.words)
    right = sum(w.right for w in card.words)
    words = sorted({w.word for w in card.words})
    return (
        f"reads {', '.join(words[:6])}{' and others' if len(words) > 6 else ''}, taught by {card.made_from.teacher}; "
        f"on demonstrations left out it answered {answered} of {seen} and agreed in {right}"
    )
