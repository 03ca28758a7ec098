"""Requests and their keys, the answer store, counting."""

from __future__ import annotations

import io
import json
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import PIL.Image
import PIL.PngImagePlugin
import pytest
from joblib import Parallel, delayed

from pix2pred.structs import Box, Image, Picture
from pix2pred.structs.views import View
from pix2pred.vlm import (
    Answer,
    AnswerStore,
    CountingVLM,
    Purpose,
    ReplayMissError,
    Request,
    StoredVLM,
    StoreMode,
    VLMError,
)

PIXELS = np.arange(8 * 6 * 3, dtype=np.uint8).reshape(6, 8, 3)
BOXES = {"patty1": Box(1.0, 2.0, 3.5, 4.0), "grill": Box(0.0, 0.0, 8.0, 6.0)}
VIEW = View(Picture("main", Image.from_pixels(PIXELS), BOXES), 3, Box(0.0, 0.0, 4.0, 4.0), True, "state 3", 256)
REQUEST = Request(Purpose.LABEL, ("Is it cooked?", VIEW, "Très bien?"), 100)
MODEL = "modèle:1"


@dataclass(slots=True)
class Echo:
    """Answers with the number of the question."""

    name: str = MODEL
    asked: list[Request] = field(default_factory=list)

    def answer(self, request: Request) -> Answer:
        self.asked.append(request)
        return Answer(f"answer {len(self.asked)}: Œ 漢字")


def test_the_key_is_the_same_on_every_machine() -> None:
    assert REQUEST.key(MODEL) == "55ac5ee9af60af39cd9492fb3526f1aae05bb4d8dc56f0b6179ef87343115f14"


def with_view(**changes: object) -> Request:
    return replace(REQUEST, parts=("Is it cooked?", replace(VIEW, **changes), "Très bien?"))  # type: ignore[arg-type]


def with_picture(**changes: object) -> Request:
    return with_view(picture=replace(VIEW.picture, **changes))  # type: ignore[arg-type]


CHANGED = {
    "text": replace(REQUEST, parts=("Is it raw?", VIEW, "Très bien?")),
    "order": replace(REQUEST, parts=(VIEW, "Is it cooked?", "Très bien?")),
    "joined": replace(REQUEST, parts=("Is it cooked?\n\nTrès bien?", VIEW)),
    "tokens": replace(REQUEST, max_tokens=101),
    "temperature": replace(REQUEST, temperature=0.5),
    "sample": replace(REQUEST, sample=1),
    "attempt": replace(REQUEST, attempt=1),
    "state": with_view(state=4),
    "crop": with_view(crop=None),
    "other crop": with_view(crop=Box(0.0, 0.0, 4.0, 5.0)),
    "marks": with_view(marks=False),
    "heading": with_view(heading="state 4"),
    "side": with_view(longest_side=512),
    "camera": with_picture(camera="left"),
    "pixels": with_picture(image=Image.from_pixels(PIXELS[::-1])),
    "box": with_picture(boxes=BOXES | {"grill": Box(0.0, 0.0, 8.0, 5.0)}),
    "box name": with_picture(boxes={"patty2": BOXES["patty1"], "grill": BOXES["grill"]}),
    "no boxes": with_picture(boxes={}),
}


@pytest.mark.parametrize("case", CHANGED)
def test_every_field_changes_the_key(case: str) -> None:
    keys = [r.key(MODEL) for r in (REQUEST, *CHANGED.values())]
    assert keys.count(CHANGED[case].key(MODEL)) == 1


def test_the_model_changes_the_key_and_the_purpose_does_not() -> None:
    assert REQUEST.key("other") != REQUEST.key(MODEL)
    assert replace(REQUEST, purpose=Purpose.DOUBLE_CHECK).key(MODEL) == REQUEST.key(MODEL)


def test_encoding_metadata_and_the_order_of_boxes_do_not_change_the_key(tmp_path: Path) -> None:
    info = PIL.PngImagePlugin.PngInfo()
    info.add_text("secret", "cooked")
    PIL.Image.fromarray(PIXELS).save(tmp_path / "a.png", compress_level=9, pnginfo=info)
    other = with_picture(image=Image(tmp_path / "a.png"), boxes=dict(reversed(BOXES.items())))
    assert other.key(MODEL) == REQUEST.key(MODEL)


def test_equal_boxes_have_equal_keys() -> None:
    whole = with_picture(boxes=BOXES | {"grill": Box(0, 0, 8, 6)})
    assert whole == REQUEST
    assert whole.key(MODEL) == REQUEST.key(MODEL)


def test_text_and_views() -> None:
    assert REQUEST.text == "Is it cooked?\n\nTrès bien?"
    assert REQUEST.views == (VIEW,)


def test_answers_come_back_and_are_plain_json(tmp_path: Path) -> None:
    store = AnswerStore(tmp_path / "стор")
    key = REQUEST.key(MODEL)
    assert store.get(key) is None
    store.put(REQUEST, MODEL, Answer("Œ\n漢字 \U0001f354"))
    assert store.get(key) == Answer("Œ\n漢字 \U0001f354", stored=True)
    entry = json.loads((store.directory / "answers" / key[:2] / f"{key}.json").read_text(encoding="utf-8"))
    assert entry["request"] == json.loads(json.dumps(REQUEST.canonical(MODEL)))
    (blob,) = (store.directory / "blobs").iterdir()
    assert blob.name == f"{VIEW.picture.image.digest}.png"
    assert Image(blob) == VIEW.picture.image, "clean: no marks, no heading, not cropped"


@pytest.mark.parametrize("format", ["PNG", "JPEG"])
def test_stored_pictures_are_clean_pngs(tmp_path: Path, format: str) -> None:
    exif = PIL.Image.Exif()
    exif[PIL.ExifTags.Base.Artist] = "Somebody"
    buffer = io.BytesIO()
    PIL.Image.fromarray(PIXELS).save(buffer, format, exif=exif)
    AnswerStore(tmp_path).put(with_picture(image=Image(buffer.getvalue())), MODEL, Answer("yes"))
    (blob,) = (tmp_path / "blobs").iterdir()
    assert blob.read_bytes().startswith(b"\x89PNG")
    assert b"Somebody" not in blob.read_bytes()


def crash(self: Path, target: object) -> Path:
    raise KeyboardInterrupt


def test_a_crash_while_writing_leaves_no_partial_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = AnswerStore(tmp_path)
    with monkeypatch.context() as patched, pytest.raises(KeyboardInterrupt):
        patched.setattr(Path, "replace", crash)
        store.put(REQUEST, MODEL, Answer("yes"))
    assert store.get(REQUEST.key(MODEL)) is None
    assert not [p for p in tmp_path.rglob("*") if p.is_file() and not p.name.startswith(".")]
    store.put(REQUEST, MODEL, Answer("yes"))
    assert store.get(REQUEST.key(MODEL)) == Answer("yes", stored=True)


DAMAGED = [b"", b"{", b"[]", b"null", b'"answer"', b"\xff", b"{}", b'{"version": 1}', b'{"version": 2, "answer": "x"}',
           b'{"version": 1, "answer": 3}', b'{"version": 1, "answer": null}']  # fmt: skip


@pytest.mark.parametrize("content", DAMAGED, ids=str)
@pytest.mark.parametrize("mode", [StoreMode.RESUME, StoreMode.REPLAY])
def test_a_damaged_file_is_an_error_naming_it(tmp_path: Path, content: bytes, mode: StoreMode) -> None:
    store = AnswerStore(tmp_path)
    store.put(REQUEST, MODEL, Answer("yes"))
    (path,) = (tmp_path / "answers").rglob("*.json")
    path.write_bytes(content)
    with pytest.raises(VLMError, match=path.name):
        StoredVLM(Echo(), store, mode).answer(REQUEST)


def test_live_always_asks_resume_asks_once(tmp_path: Path) -> None:
    store, model = AnswerStore(tmp_path), Echo()
    resume, live = StoredVLM(model, store), StoredVLM(model, store, StoreMode.LIVE)
    answers = [m.answer(REQUEST) for m in (resume, resume, live, resume)]
    assert [a.text[:8] for a in answers] == ["answer 1", "answer 1", "answer 2", "answer 2"]
    assert [a.stored for a in answers] == [False, True, False, True]
    assert resume.name == MODEL


def test_replay_never_asks(tmp_path: Path) -> None:
    store, model = AnswerStore(tmp_path), Echo()
    replay = StoredVLM(model, store, StoreMode.REPLAY)
    with pytest.raises(ReplayMissError, match="no answer to a label query of modèle:1"):
        replay.answer(REQUEST)
    store.put(REQUEST, MODEL, Answer("yes"))
    assert replay.answer(REQUEST) == Answer("yes", stored=True)
    with pytest.raises(ReplayMissError):
        replay.answer(replace(REQUEST, attempt=1))
    assert model.asked == []


def test_a_model_that_fails_stores_nothing(tmp_path: Path) -> None:
    class Down:
        name = MODEL

        def answer(self, request: Request) -> Answer:
            raise VLMError("no network")

    with pytest.raises(VLMError, match="no network"):
        StoredVLM(Down(), AnswerStore(tmp_path)).answer(REQUEST)
    assert not [p for p in tmp_path.rglob("*") if p.is_file()]


def test_stores_merge_by_copying(tmp_path: Path) -> None:
    requests = [replace(REQUEST, sample=i) for i in range(4)]
    for i, request in enumerate(requests):
        AnswerStore(tmp_path / f"{i % 2}").put(request, MODEL, Answer(f"answer {i}"))
    shutil.copytree(tmp_path / "1", tmp_path / "0", dirs_exist_ok=True)
    merged = AnswerStore(tmp_path / "0")
    assert [merged.get(r.key(MODEL)) for r in requests] == [Answer(f"answer {i}", stored=True) for i in range(4)]


def run(work: Callable[[Request], Answer], requests: list[Request]) -> list[Answer]:
    answers: list[Answer] = Parallel(n_jobs=8, prefer="threads")(delayed(work)(r) for r in requests)
    return answers


def test_threads_may_share_a_store_and_a_count(tmp_path: Path) -> None:
    requests = [replace(REQUEST, sample=i % 10, purpose=(Purpose.LABEL, Purpose.PROPOSE)[i % 2]) for i in range(200)]
    counting = CountingVLM(StoredVLM(Echo(), AnswerStore(tmp_path)))
    answers = run(counting.answer, requests)
    assert len(answers) == 200
    assert counting.name == MODEL
    counts = counting.usage.as_dict()
    assert list(counts) == ["label", "propose"]
    assert [c["queries"] for c in counts.values()] == [100, 100]
    assert sum(c["from_store"] for c in counts.values()) == sum(a.stored for a in answers)
    files = [p for p in tmp_path.rglob("*") if p.is_file()]
    assert len(files) == 10 + 1, "ten answers, one picture, nothing half written"
    replayed = run(StoredVLM(Echo(), AnswerStore(tmp_path), StoreMode.REPLAY).answer, requests)
    assert all(a.stored for a in replayed)


def test_counts_start_empty() -> None:
    assert CountingVLM(Echo()).usage.as_dict() == {}
