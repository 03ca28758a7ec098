"""The report: what it says, that it says it safely, and that nothing is loaded from outside."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lamps_run import BOMB, learn_lamps
from pix2pred.predicates import CORRECTIONS
from pix2pred.report import REPORT, load_contents, render, write_report
from pix2pred.report.sections.attention import unsure
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.runs.learn import relearn


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    return learn_lamps(tmp_path_factory.mktemp("lamps"))


class Page(HTMLParser):
    """The tags of a page with their attributes, and the text of its tables."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.data: dict[str, Any] = {}
        self.pictures: list[str] = []
        self._inside: str | None = None
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self._inside = dict(attrs).get("id") if tag == "script" else None

    def handle_data(self, data: str) -> None:
        if self._inside == "data":
            self.data = json.loads(data)
        elif self._inside == "pictures":
            self.pictures = data.split("\n")
        self._inside = None

    def count(self, tag: str) -> int:
        return sum(name == tag for name, _ in self.tags)


def page(run: RunFolder) -> Page:
    return Page((run.path / REPORT).read_text())


def test_labels_pictures_and_explanations_are_inside(run: RunFolder) -> None:
    parsed = page(run)
    data = parsed.data
    lit = next(i for i, p in enumerate(data["predicates"]) if p["phrase"] == "lit")
    demo = data["demos"][0]
    rows = {tuple(atom): i for i, atom in enumerate(demo["atoms"])}
    names = [o[0] for o in demo["objects"]]
    row = rows[lit, names.index("l1")]
    assert demo["labels"][row] == "011"
    assert [data["explanations"][n] for n in demo["why"][str(row)]] == [f"As seen {BOMB}"] * 3
    assert len({s[0]["picture"] for s in demo["states"]}) == 3
    assert all(uri.startswith("data:image/webp;base64,") for uri in parsed.pictures)
    assert len(parsed.pictures) == len(set(parsed.pictures)) == 6
    assert demo["states"][1][0]["crop"] is not None


def test_who_said_what_and_where_the_two_differed_is_shown(run: RunFolder) -> None:
    said = {
        "by_reader": 40, "by_model": 3, "questions": 2, "checked": 20, "differed": 1, "drifted": True,
        "words": {"lit": {"by_reader": 40, "by_model": 3, "checked": 20, "differed": 1}},
        "differences": [{"picture": "ab" * 32, "atom": f"lit({BOMB})", "read": True, "said": False}],
    }  # fmt: skip
    summary = {"solved": 0, "tasks": 0, "failures": {}, "episodes": []}
    contents = load_contents(run)
    text = render(replace(contents, solved={"old": summary, "new": summary | {"said_by": said}}))
    assert text.count("Who said what") == 1 and "40 labels by the reader, 3 by the large model in 2 questions" in text
    assert "was read as true; the large model says false" in text and "distil --resume" in text and BOMB not in text
    calm = render(replace(contents, solved={"new": summary | {"said_by": said | {"drifted": False}}}))
    assert "distil --resume" not in calm


def test_sections_say_what_happened(run: RunFolder) -> None:
    text = (run.path / REPORT).read_text()
    for expected in ("ghost is not an object", "true in no state", "transitions in support", "Steps of the climb"):
        assert expected in text
    contents = load_contents(run)
    assert all(reading.verdict == "supports" for reading in contents.readings)
    assert {r.operator for r in contents.readings} == {op.name for op in contents.model.operators}


def test_tables_have_headers_and_captions(run: RunFolder) -> None:
    tags = page(run).tags
    tables = sum(tag == "table" for tag, _ in tags)
    assert tables >= 4
    assert sum(tag == "caption" for tag, _ in tags) == tables
    assert all("scope" in attributes for tag, attributes in tags if tag == "th")


def test_nothing_is_loaded_from_outside(run: RunFolder) -> None:
    parsed = page(run)
    for _, attributes in parsed.tags:
        for name in ("src", "href", "srcset", "action"):
            assert (attributes.get(name) or "#").startswith(("#", "data:"))
    text = (run.path / REPORT).read_text()
    assert not re.search(r"url\(\s*['\"]?https?:|@import", text)
    policy = next(a["content"] for tag, a in parsed.tags if "http-equiv" in a) or ""
    assert "default-src 'none'" in policy and "unsafe-eval" not in policy
    script = policy.partition("script-src")[2].partition(";")[0]
    assert "'sha256-" in script and "unsafe-inline" not in script


def test_hostile_texts_stay_texts(run: RunFolder) -> None:
    parsed = page(run)
    assert parsed.count("script") == 3  # data, program and pictures
    assert parsed.count("img") == 0
    assert not any(name.startswith("on") for _, attributes in parsed.tags for name in attributes)
    review = Page(render(load_contents(run), review=True))
    assert (review.count("script"), review.count("img")) == (4, 0)


def test_markup_in_descriptors_names_and_answers_stays_text(tmp_path: Path) -> None:
    """In the report, and in the page that ``pix2pred review`` serves."""
    run = learn_lamps(tmp_path, f"<b onclick=boom>{BOMB.replace('/', '')}", descriptor=f"arm {BOMB}")
    for text, scripts in (((run.path / REPORT).read_text(), 3), (render(load_contents(run), review=True), 4)):
        parsed = Page(text)
        assert (parsed.count("script"), parsed.count("img"), parsed.count("b")) == (scripts, 0, 0)
        assert not any(name.startswith("on") for _, attributes in parsed.tags for name in attributes)
        assert f"arm {BOMB}" in [o[2] for o in parsed.data["demos"][0]["objects"]]
        assert any(BOMB in why for why in parsed.data["explanations"])
        assert "onclick=boom&gt;" in text


def test_corrections_reach_learning_and_the_report_shows_before_and_after(tmp_path: Path) -> None:
    run = learn_lamps(tmp_path)
    before = (run.path / "labels/as_said.json").read_bytes()
    when: dict[str, object] = {"when": "2026-01-01T00:00:00Z"}
    rows: list[dict[str, object]] = [
        {"kind": "label", "demo": "d0", "state": 0, "atom": ["bright0", "l1"], "old": "false", "new": "true"},
        {"kind": "rename", "predicate": "lit0", "old": "lit0", "new": "<script>shines</script>"},
        {"kind": "standing", "predicate": "lit0", "old": "free", "new": "pinned"},
    ]
    (run.path / CORRECTIONS).write_text("".join(json.dumps(when | row) + "\n" for row in rows))
    learned = relearn(run)
    write_report(run)
    assert [p.name for p in learned.selected.selection.pinned] == ["<script>shines</script>"]
    assert learned.metrics["corrections"] == 3
    assert (run.path / "labels/as_said.json").read_bytes() == before
    text = (run.path / REPORT).read_text()
    assert "Before and after" in text and "&lt;script&gt;shines" in text and "<script>shines" not in text
    data = page(run).data
    bright = next(i for i, p in enumerate(data["predicates"]) if p["phrase"] == "bright")
    demo = data["demos"][0]
    row = next(i for i, atom in enumerate(demo["atoms"]) if atom[0] == bright and demo["objects"][atom[1]][0] == "l1")
    assert (demo["labels"][row], demo["said"][str(row)]) == ("100", "000")
    assert [h["corrections"] for h in load_contents(run).history] == [0, 3]


def test_labels_that_the_model_was_unsure_of_are_listed(run: RunFolder) -> None:
    contents = load_contents(run)
    demos = []
    for demo in contents.table.demos:
        confidence = np.full(demo.values.shape, np.nan, dtype=np.float32)
        confidence[1, :] = 0.6 if demo.name == "d1" else 0.95
        demos.append(replace(demo, confidence=confidence))
    advice = {**contents.advice, "predicates": ["lit0"]}
    voted = replace(contents, advice=advice, table=replace(contents.table, demos=tuple(demos)))
    found = unsure(voted)
    assert {(u.demo, u.state, u.atom[0]) for u in found} == {("d1", 1, "lit0")}
    assert unsure(contents) == [] and "unsure of" not in render(contents)
    text = render(voted)
    assert "the model itself was unsure of" in text and f"{found[0].text}, d1, state 1: " in text


def test_an_unfinished_run_is_refused(tmp_path: Path) -> None:
    run = learn_lamps(tmp_path)
    (run.path / "labels/evidence.json").unlink()
    with pytest.raises(RunFolderError, match="finish the run"):
        load_contents(run)
