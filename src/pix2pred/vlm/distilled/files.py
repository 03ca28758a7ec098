"""A reader as files: ``card.json`` says what it is and how good, ``weights.npz`` holds its numbers as plain arrays.

Nothing is executed or unpickled. The card names the SHA-256 of the weights, so that changed ones are refused.
"""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError

from pix2pred.structs.formats.documents import Document
from pix2pred.system.errors import Pix2predError, first_fault
from pix2pred.system.files import write_whole
from pix2pred.vlm.distilled.calibration import SCORES, Calibration
from pix2pred.vlm.distilled.codes import PartCode, RegionCode
from pix2pred.vlm.distilled.fitting.fit import Fitted
from pix2pred.vlm.distilled.machine import Kernel, Layout, Rows, WordMachine
from pix2pred.vlm.distilled.model import Bars, ByName, DistilledModel, KindsModel, WordReader
from pix2pred.vlm.distilled.sight import PARTS, Array

CARD, WEIGHTS = "card.json", "weights.npz"
VERSION = 3
"""The second knows what lies about an object, the third what names tell; earlier readers are read as they are."""
LARGEST = 20_000_000
"""Bytes of weights that are read: readers have less than a quarter of that."""


class ReaderFileError(Pix2predError, ValueError):
    """A folder that holds no reader this program can use; the message says why and what to do."""


class KernelDoc(Document):
    """See ``machine.Kernel``."""

    linear: float
    scale: float
    parts: tuple[str, ...]


class CurveDoc(Document):
    """See ``calibration.Calibration``."""

    slope: float
    middle: float
    error: float
    most: float


class TaughtWordDoc(Document):
    """A word: what it is asked about, how it did on demonstrations left out, and how it is computed."""

    word: str
    kinds: tuple[str, ...]
    seen: int = Field(description="atoms labelled by the teacher")
    true: int = Field(description="of them true")
    answered: int = Field(description="of them answered when their demonstration was left out")
    right: int = Field(description="of the answers like the teacher's")
    teacher_error: float = Field(description="share of the teacher's labels that the reader takes to be wrong")
    kernel: KernelDoc
    curve: CurveDoc
    by_name: dict[str, bool] = Field({}, description="of a word that does not change: its value by the object's name")
    name_right: float = Field(0.5, gt=0, lt=1, description="how probably names are right")


class UntaughtDoc(Document):
    """A word that could not be taught, and why."""

    word: str
    kinds: tuple[str, ...]
    reason: str


class MadeFrom(Document):
    """What a reader was made of."""

    teacher: str = Field(description="the model whose labels it learned")
    vocabulary: str
    demonstrations: int
    episodes: int
    looks: int
    labels: int
    corrected: int = Field(description="labels set right by a person")
    doubted: int = Field(description="labels that learning took to be wrong, used as it takes them to be")
    data: str = Field(description="SHA-256 of the labels and pictures")


class CardDoc(Document):
    """The file ``card.json``."""

    format: Literal["pix2pred-distilled-reader"]
    version: Literal[1, 2, 3]
    what: str
    not_for: tuple[str, ...]
    made_from: MadeFrom
    settings: dict[str, float]
    sure: float
    strange: float
    words: tuple[TaughtWordDoc, ...]
    untaught: tuple[UntaughtDoc, ...]
    kinds: tuple[tuple[str, ...], ...] = Field(description="kinds of objects, in the order of the weights")
    regions: tuple[str, ...] = Field(description="kinds of regions, in the order of the weights")
    layouts: tuple[dict[str, tuple[int, int]], ...] = Field(description="by kinds: where the parts of a code lie")
    company: tuple[str, ...] = Field((), description="types of objects that are looked for about an object")
    weights: str = Field(description="SHA-256 of weights.npz")


WHAT = (
    "small classifiers that read yes/no labels from crops of pictures; trained on another model's labels, measured on "
    "demonstrations that were left out"
)
NOT_FOR = (
    "scenes, objects or cameras other than those it was made from: it then says that it does not know, or is wrong",
    "words it was not taught, or questions other than labels",
    "anything whose failure harms people",
)


def write_reader(directory: Path, fitted: Fitted, made_from: MadeFrom, settings: Mapping[str, float]) -> CardDoc:
    """Write both files; equal readers give equal bytes. Gives the card."""
    model = fitted.model
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **_arrays(model))  # type: ignore[arg-type]
    content = buffer.getvalue()
    words = []
    for result in fitted.results:
        taught = model.kinds[result.kinds].words[result.word]
        kernel, curve = taught.machine.kernel, taught.calibration
        words.append(
            TaughtWordDoc(
                word=result.word, kinds=result.kinds, seen=result.seen, true=result.true, answered=result.answered,
                right=result.right, teacher_error=result.teacher_error,
                kernel=KernelDoc(linear=kernel.linear, scale=kernel.scale, parts=kernel.parts),
                curve=CurveDoc(slope=curve.slope, middle=curve.middle, error=curve.error, most=curve.most),
                by_name=dict(taught.by_name.values), name_right=taught.by_name.probability,
            )
        )  # fmt: skip
    card = CardDoc(
        format="pix2pred-distilled-reader", version=VERSION, what=WHAT, not_for=NOT_FOR, made_from=made_from,
        settings=dict(settings), sure=model.bars.sure, strange=model.bars.strange, words=tuple(words),
        untaught=tuple(UntaughtDoc(word=u.word, kinds=u.kinds, reason=u.reason) for u in fitted.untaught),
        kinds=tuple(model.kinds), regions=tuple(model.regions),
        layouts=tuple(dict(m.rows.layout.places) for m in model.kinds.values()), company=model.company,
        weights=hashlib.sha256(content).hexdigest(),
    )  # fmt: skip
    write_whole(directory / WEIGHTS, content)
    write_whole(directory / CARD, (json.dumps(card.model_dump(mode="json"), indent=1) + "\n").encode())
    return card


def _arrays(model: DistilledModel) -> dict[str, NDArray[np.generic]]:
    arrays: dict[str, NDArray[np.generic]] = {}
    for r, region in enumerate(model.regions.values()):
        for part, code in region.parts.items():
            arrays[f"region|{r}|{part}|mean"] = code.mean.astype(np.float16)
            arrays[f"region|{r}|{part}|components"] = code.components.astype(np.float16)
            arrays[f"region|{r}|{part}|spread"] = code.spread
            arrays[f"region|{r}|{part}|residual"] = np.array([code.residual])
    for k, kinds in enumerate(model.kinds.values()):
        arrays[f"kinds|{k}|rows"] = kinds.rows.codes.astype(np.float16)
        arrays[f"kinds|{k}|relation"] = kinds.relation
        arrays[f"kinds|{k}|spreads"] = kinds.rows.layout.spreads
        arrays[f"kinds|{k}|nearest"] = np.array([kinds.nearest])
        for word, taught in kinds.words.items():
            arrays[f"kinds|{k}|word|{word}"] = taught.machine.weights
            arrays[f"kinds|{k}|odds|{word}"] = taught.calibration.odds.astype(np.float32)
    return arrays


def read_reader(directory: Path) -> tuple[DistilledModel, CardDoc, str]:
    """The reader in a folder, its card, and the digest of both files. Raises ``ReaderFileError``."""
    card, text = _read_card(directory)
    path = directory / WEIGHTS
    try:
        content = path.read_bytes() if path.stat().st_size <= LARGEST else b""
    except OSError as error:
        raise ReaderFileError(f"{path}: cannot be read ({error.strerror}); distil the reader again") from error
    if hashlib.sha256(content).hexdigest() != card.weights:
        raise ReaderFileError(f"{path}: is damaged, or not what {CARD} describes; distil the reader again")
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as stored:
            model = _model(card, {name: stored[name] for name in stored.files})
    except (OSError, ValueError, KeyError, IndexError, zipfile.BadZipFile) as error:
        raise ReaderFileError(f"{path}: does not fit {CARD} ({error}); distil the reader again") from error
    return model, card, hashlib.sha256(text + content).hexdigest()


def _read_card(directory: Path) -> tuple[CardDoc, bytes]:
    path = directory / CARD
    try:
        text = path.read_bytes()
        document = json.loads(text)
    except FileNotFoundError as error:
        raise ReaderFileError(
            f"{directory}: holds no reader (no {CARD}); make one with 'pix2pred distil RUN --out READER'"
        ) from error
    except (OSError, ValueError, RecursionError) as error:
        raise ReaderFileError(f"{path}: cannot be read as a reader's card ({error}); distil it again") from error
    version = document.get("version") if isinstance(document, dict) else None
    if isinstance(version, int) and version > VERSION:
        raise ReaderFileError(
            f"{path}: is of version {version}, this program reads version {VERSION}; update pix2pred, or distil again"
        )
    try:
        return CardDoc.model_validate(document), text
    except ValidationError as error:
        where, first = first_fault(error)
        raise ReaderFileError(f"{path}: {where}: {first['msg']}; distil the reader again") from error


def _model(card: CardDoc, arrays: Mapping[str, NDArray[Any]]) -> DistilledModel:
    regions = {
        kind: RegionCode({part: _part_code(arrays, f"region|{r}|{part}") for part in PARTS})
        for r, kind in enumerate(card.regions)
    }
    kinds: dict[tuple[str, ...], KindsModel] = {}
    for k, name in enumerate(card.kinds):
        rows = _floats(arrays[f"kinds|{k}|rows"])
        layout = Layout(dict(card.layouts[k]), _floats(arrays[f"kinds|{k}|spreads"]))
        words: dict[str, WordReader] = {}
        for doc in card.words:
            if doc.kinds == name:
                kernel = Kernel(doc.kernel.linear, doc.kernel.scale, doc.kernel.parts)
                weights = _floats(arrays[f"kinds|{k}|word|{doc.word}"])
                odds = arrays.get(f"kinds|{k}|odds|{doc.word}", doc.curve.slope * (SCORES - doc.curve.middle))
                curve = Calibration(**doc.curve.model_dump(), odds=odds.astype(np.float64))
                words[doc.word] = WordReader(WordMachine(kernel, weights), curve, ByName(doc.by_name, doc.name_right))
        nearest = float(arrays[f"kinds|{k}|nearest"][0])
        kinds[name] = KindsModel(Rows(layout, rows), _floats(arrays[f"kinds|{k}|relation"]), nearest, words)
    return DistilledModel(regions, kinds, Bars(card.sure, card.strange), card.company)


def _part_code(arrays: Mapping[str, NDArray[Any]], name: str) -> PartCode:
    mean, components, spread = (_floats(arrays[f"{name}|{field}"]) for field in ("mean", "components", "spread"))
    return PartCode(mean, components, spread, float(arrays[f"{name}|residual"][0]))


def _floats(array: NDArray[Any]) -> Array:
    return array.astype(np.float32)
