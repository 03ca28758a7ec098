"""Report and review in a real browser: read, correct by mouse and by keyboard, learn again; nothing else is asked."""

from __future__ import annotations

import base64
import json
import re
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import pix2pred as p2p
from browser import chromium
from cli.hostile_lamps import Fake, sees, write_lamps
from extras import need
from lamps_run import BOMB, learn_lamps
from pix2pred.predicates import CORRECTIONS
from pix2pred.report import REPORT
from pix2pred.review import ReviewServer
from pix2pred.runs.folder import RunFolder

pytestmark = need("playwright", extra="browser")


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as made:
        yield made


@pytest.fixture
def page(browser: Any) -> Iterator[Any]:
    """A page that fails the test when it logs anything, throws, or asks for what is not its own."""
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    made = context.new_page()
    made.set_default_timeout(60_000)
    made.noise, made.asked = [], []
    made.on("console", lambda message: made.noise.append(message.text))
    made.on("pageerror", lambda error: made.noise.append(str(error)))
    made.on("request", lambda request: made.asked.append(request.url))
    yield made
    assert made.noise == []
    assert made.evaluate("window.boom") is None
    context.close()


@pytest.fixture
def run(tmp_path: Path) -> RunFolder:
    return learn_lamps(tmp_path, demos=4)


@pytest.fixture
def server(run: RunFolder) -> Iterator[ReviewServer]:
    with ReviewServer(run) as made:
        threading.Thread(target=made.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True).start()
        yield made
        made.shutdown()


def saved(run: RunFolder) -> list[dict[str, Any]]:
    path = run.path / CORRECTIONS
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def test_the_static_page_asks_for_nothing(page: Any, run: RunFolder) -> None:
    uri = (run.path / REPORT).resolve().as_uri()
    page.goto(uri)
    page.wait_for_selector("#d0 td[data-state]")
    for details in page.locator("details.demo").all():
        details.evaluate("x => { x.open = true }")
    page.locator("#filter").select_option("all")
    page.locator("#constant").check()
    page.wait_for_selector("#d3 td[data-state]")
    assert [url for url in page.asked if not url.startswith(("data:", "blob:"))] == [uri]
    cell = page.locator('#d0 td[aria-label^="lit0(l1), state 1"]')
    cell.hover()
    assert "As seen" in page.locator("#d0 .panel").inner_text()
    page.locator('#d0 td[aria-label^="lit0(l1), state 0"]').focus()
    page.keyboard.press("ArrowRight")
    assert "true in state 1" in " ".join(page.locator("#d0 .panel").inner_text().split())
    before = page.locator('#d0 td[aria-label^="lit0(l1), state 1"]').inner_text()
    page.keyboard.press("Space")
    assert page.locator('#d0 td[aria-label^="lit0(l1), state 1"]').inner_text() == before


def test_flip_ten_labels_rename_ban_and_learn_again(page: Any, run: RunFolder, server: ReviewServer) -> None:
    page.goto(server.url)
    page.wait_for_selector("#d0 td[data-state]")
    page.locator("#search").fill("lit0")
    flipped = 0
    for d in range(4):
        page.locator(f"#d{d}").evaluate("x => { x.open = true }")
        page.wait_for_selector(f"#d{d} td[data-state]")
        for state in (0, 1, 2) if d < 2 else (0, 1):
            page.locator(f'#d{d} td[aria-label^="lit0(l1), state {state}"]').click()
            flipped += 1
    assert flipped == 10
    page.wait_for_selector("#waiting >> text=/^10 corrections/")
    page.locator("#d0 button", has_text="Rename").click()
    page.keyboard.type("shines")
    page.keyboard.press("Enter")
    page.wait_for_selector("#d0 .group >> text=shines")
    page.locator("#search").fill("near0")
    page.locator("#constant").check()
    page.locator("#d0 button", has_text="Ban").click()
    page.wait_for_selector("#waiting >> text=/^12 corrections/")
    assert [r["kind"] for r in saved(run)] == ["label"] * 10 + ["rename", "standing"]
    page.locator("#learn").click()
    page.wait_for_selector("#changes")
    text = page.locator("#changes").inner_text()
    assert "12" in text and "name of lit0" in page.locator("#changes").evaluate("x => x.textContent")
    assert page.locator("#waiting").inner_text() == "Everything is learned with."
    outcome = page.locator('#pool tr[data-predicate="near0"]').inner_text()
    assert "banned" in outcome and "shines" in page.locator('#pool tr[data-predicate="lit0"]').inner_text()
    assert all(url.startswith((server.url, "data:", "blob:")) for url in page.asked)


def test_by_keyboard_alone(page: Any, run: RunFolder, server: ReviewServer) -> None:
    page.goto(server.url)
    page.wait_for_selector("#d0 td[data-state]")

    def tab_to(condition: str) -> None:
        for _ in range(200):
            page.keyboard.press("Tab")
            if page.evaluate(f"(() => {{ const x = document.activeElement; return Boolean({condition}) }})()"):
                return
        raise AssertionError(f"no way by keyboard to {condition}")

    tab_to("x.id === 'filter'")
    page.keyboard.type("all")
    page.keyboard.press("Tab")
    page.keyboard.press("Space")
    assert page.locator("#constant").is_checked()
    tab_to("x.matches('#d0 td[data-state]')")
    for _ in range(40):
        if page.evaluate("document.activeElement.getAttribute('aria-label')").startswith("lit0(l2), state 0"):
            break
        page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("u")
    page.wait_for_selector('td:focus[aria-label*="state 1: unknown, corrected"]')
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Space")
    page.wait_for_selector('td:focus[aria-label*="state 2: false, corrected"]')
    page.keyboard.press("x")
    page.wait_for_selector('td:focus[aria-label$="state 2: true"]')
    assert [(r["state"], r["new"]) for r in saved(run)] == [(1, "unknown"), (2, "false"), (2, "true")]
    page.evaluate("document.querySelector('nav a').focus()")
    tab_to("x.id === 'learn'")
    page.keyboard.press("Enter")
    page.wait_for_selector("#changes")


def test_two_pages_see_each_other(browser: Any, page: Any, run: RunFolder, server: ReviewServer) -> None:
    other = browser.new_page()
    for one in (page, other):
        one.goto(server.url)
        one.wait_for_selector("#d0 td[data-state]")
        one.locator("#search").fill("lit0")
    page.locator('#d0 td[aria-label^="lit0(l1), state 0"]').click()
    other.locator('#d0 td[aria-label^="lit0(l2), state 2"]').click()
    for one in (page, other):
        one.wait_for_selector('#d0 td.corrected[aria-label^="lit0(l1), state 0: true"]')
        one.wait_for_selector('#d0 td.corrected[aria-label^="lit0(l2), state 2: false"]')
    assert len(saved(run)) == 2
    other.close()


def test_the_page_of_a_plan_asks_for_nothing_and_runs_nothing(page: Any, tmp_path: Path) -> None:
    folder = write_lamps(tmp_path / "lamps")
    sheet = folder / "tasks/t0/task.yaml"
    sheet.write_text(sheet.read_text().replace("{type: robot}", f"{{type: robot, descriptor: {json.dumps(BOMB)}}}"))
    hostile = Fake(label=lambda request: sees(request).replace("As seen.", f"As seen {BOMB}"))
    model = p2p.learn(folder, vlm=hostile)
    path = tmp_path / "plan.html"
    path.write_text(p2p.Model.explain(model.plan(folder / "tasks/t0")))
    page.goto(path.resolve().as_uri())
    assert "window.boom=1" in page.locator("#plan").inner_text()
    page.locator("nav a", has_text="What it rests on").click()
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.set_viewport_size({"width": 420, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert [url for url in page.asked if not url.startswith("data:")][:1] == [path.resolve().as_uri()]
    assert all(url.startswith(("data:", "file:")) for url in page.asked)


def test_names_that_every_javascript_object_has(page: Any, run: RunFolder) -> None:
    path = run.path / "named.html"
    path.write_text((run.path / REPORT).read_text().replace("robby", "constructor").replace("lit0", "valueOf"))
    page.goto(path.resolve().as_uri())
    page.locator("#filter").select_option("all")
    page.locator('#d0 td[aria-label^="valueOf(l1), state 1"]').focus()
    page.locator("#d0-s1 button").click()
    assert "Press(constructor, l1)" in page.locator("#d0 .panel").inner_text()


def test_a_large_report_is_small_and_quick(page: Any, run: RunFolder) -> None:
    """12 demonstrations, 100 predicates and pictures that all differ, in the form that real runs have."""
    text = (run.path / REPORT).read_text()
    start = text.index(">", text.index('id="data"')) + 1
    end = text.index("</script>", start)
    data = json.loads(text[start:end])
    demo = data["demos"][0]
    states, objects = 15, [[f"o{i}", "lamp", ""] for i in range(8)]
    data["predicates"] = [{**data["predicates"][0], "name": f"p{i}", "types": ["lamp"]} for i in range(100)]
    big = {
        **demo, "objects": objects, "atoms": [[p, o] for p in range(100) for o in range(8)], "said": {},
        "labels": ["01" * 7 + "?"] * 800, "why": {str(i): [0] * states for i in range(800)},
        "actions": [{"text": "Press(o0)", "objects": [0]}] * (states - 1), "states": (demo["states"] * 5)[:states],
    }  # fmt: skip
    data["demos"] = [{**big, "name": f"d{i}"} for i in range(12)]
    text, before, rest = (text[:end], *text[end:].rpartition('id="pictures">')[::2])
    pictures, after = rest.split("</script>", 1)
    larger = [base64.b64encode(base64.b64decode(uri.partition(",")[2]) + bytes(15_000)) for uri in pictures.split("\n")]
    embedded = "\n".join("data:image/webp;base64," + p.decode() for p in larger * 15)
    rest = f'{before}id="pictures">{embedded}</script>{after}'
    data["suspicions"] = []
    details = re.search(r"<details class=\"demo\".*?</details>", text, re.S)
    assert details is not None
    first = details[0]
    more = "".join(first.replace('id="d0"', f'id="d{i}"').replace('demo="0" open', f'demo="{i}"') for i in range(4, 12))
    text = text[:start] + json.dumps(data).replace("<", "\\u003c") + rest
    text = text.replace('<section id="selection"', more + '<section id="selection"', 1)
    assert len(text) < 20_000_000
    path = run.path / "large.html"
    path.write_text(text)
    page.goto(path.resolve().as_uri())
    page.wait_for_selector("#d0 td[data-state]")
    assert page.locator("#d0 tr.row").count() == 800
    assert page.locator("#d11 tr.row").count() == 0  # drawn when opened
