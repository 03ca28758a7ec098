"""How large and how quick the report of a large run is: by default 12 demonstrations and 100 candidate predicates.

    python benchmarks/report_size.py

needs the extra ``browser`` and Chromium. A run folder is made up (rendered pictures, drawn labels, a sentence for every
label), its report written by the program itself, and opened three times by a fresh headless Chromium: the time is from
asking for the page to its ``load`` event, and to the first frame with a table; scrolling is the longest frame while the
whole page is scrolled through, beginning a second after it was loaded. On a machine that does other things, look at the
processor time until then, which waiting does not change; it is that of all the browser's pages, its own included.
"""

from __future__ import annotations

import argparse
import shutil
import statistics
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from pix2pred.demos import Project, project_digest
from pix2pred.domains.burger import BurgerDomain
from pix2pred.learning import LearningSettings
from pix2pred.pipeline import LearningProblem
from pix2pred.report import write_report
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.learn import learn_into
from pix2pred.settings import Settings
from pix2pred.structs import Demo
from pix2pred.vlm import Answer, AnswerStore, Purpose, Request, StoredVLM
from pix2pred.vlm.offline.prompt_format import asked_atoms

WHY = "The surface looks evenly lit and nothing covers it, which matches what was said about the state before."


class Talkative:
    """Proposes ``predicates`` words for every patty, labels them by a rule, and explains each label differently."""

    name = "talkative"

    def __init__(self, predicates: int) -> None:
        self._words = [f"word_{chr(97 + i // 26)}{chr(97 + i % 26)}" for i in range(predicates)]

    def answer(self, request: Request) -> Answer:
        """A proposal, or labels that depend on word, object and state."""
        if request.purpose == Purpose.PROPOSE:
            return Answer("\n".join(f"* {word}(patty1)" for word in self._words))
        state = max((view.state for view in request.views), default=0)
        lines = []
        for atom in asked_atoms(request.text):
            word = self._words.index(atom.word) if atom.word in self._words else 0
            lines.append(f"* {atom}: {(word + state) % 3 == 0}. {WHY} Seen in state {state}, {word}.")
        return Answer("\n".join(lines))


def large_run(folder: Path, demos: int, predicates: int, states: int) -> RunFolder:
    """A finished run; every demonstration is one rendered meal, its pictures shaded so that all differ."""
    domain = BurgerDomain()
    (meal, *_) = domain.demonstrations("more-stacks", 0)
    drawn = [_lengthened(replace(meal, name=f"meal-{d:02d}"), d, states) for d in range(demos)]
    vocabulary = domain.vocabulary("more-stacks")
    settings = Settings(learning=LearningSettings(operators="cluster-and-intersect", max_plans=2, j_threshold=1e9))
    with RunFolder(folder).locked() as run:
        model = Talkative(predicates)
        run.claim(
            {
                "data": project_digest(Project(vocabulary, tuple(drawn), {}, None)), "vlm": "talkative",
                "model": model.name, "simulator": {}, "settings": settings.model_dump(mode="json"), "answers": None,
            }
        )  # fmt: skip
        learn_into(run, LearningProblem(vocabulary, drawn, StoredVLM(model, AnswerStore(run.path)), settings))
        return run


def _lengthened(demo: Demo, number: int, states: int) -> Demo:
    """``demo`` repeated or cut to so many states, without features, every picture unlike all others."""
    from pix2pred.structs import Image, Picture, State

    rng = np.random.default_rng(number)
    made, actions = [], []
    for t in range(states):
        picture = demo.states[t % len(demo.states)].pictures[0]
        pixels = np.clip(picture.image.pixels().astype(np.int16) + rng.integers(-12, 13), 0, 255).astype(np.uint8)
        pixels[:4, :4] = rng.integers(0, 256, 3)
        shown = Picture(picture.camera, Image.from_pixels(pixels), picture.boxes)
        made.append(State((shown,), {}, demo.states[t % len(demo.states)].given))
        if t:
            actions.append(demo.actions[(t - 1) % len(demo.actions)])
    return replace(demo, states=tuple(made), actions=tuple(actions))


def measure(page: Path, tries: int) -> dict[str, list[float]]:
    """Milliseconds by what was measured, a number per try."""
    from playwright.sync_api import sync_playwright

    program = shutil.which("chromium") or shutil.which("google-chrome")
    found: dict[str, list[float]] = {name: [] for name in ("load", "first table", "processor", "longest frame")}
    with sync_playwright() as playwright:
        for _ in range(tries):
            browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
            opened: Any = browser.new_page(viewport={"width": 1280, "height": 900})
            system = browser.new_browser_cdp_session()
            opened.add_init_script(FIRST_TABLE)
            before = _processor(system)
            opened.goto(page.resolve().as_uri(), wait_until="load")
            timing = "performance.getEntriesByType('navigation')[0]"
            found["load"].append(opened.evaluate(f"{timing}.loadEventEnd - {timing}.startTime"))
            opened.wait_for_function("window.firstTable")
            found["first table"].append(opened.evaluate("window.firstTable"))
            found["processor"].append(_processor(system) - before)
            opened.wait_for_timeout(1000)
            found["longest frame"].append(opened.evaluate(SCROLL))
            browser.close()
    return found


def _processor(system: Any) -> float:
    """Milliseconds of processor time that pages have used."""
    processes = system.send("SystemInfo.getProcessInfo")["processInfo"]
    return 1000 * sum(float(p["cpuTime"]) for p in processes if p["type"] == "renderer")


FIRST_TABLE = """new MutationObserver((_, observer) => {
  if (!document.querySelector("#d0 td[data-state]")) return;
  observer.disconnect();
  requestAnimationFrame(() => setTimeout(() => { window.firstTable = performance.now(); }));
}).observe(document, { subtree: true, childList: true })"""

SCROLL = """() => new Promise((done) => {
  let last = performance.now(), longest = 0;
  const step = (now) => {
    longest = Math.max(longest, now - last); last = now;
    scrollBy({ top: 300, behavior: "instant" });
    const end = scrollY + innerHeight >= document.documentElement.scrollHeight - 2;
    if (end) done(longest); else requestAnimationFrame(step);
  };
  requestAnimationFrame((now) => { last = now; requestAnimationFrame(step); });
})"""


def main() -> None:
    """Make, write, open, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--demos", type=int, default=12)
    parser.add_argument("--predicates", type=int, default=100)
    parser.add_argument("--states", type=int, default=15)
    parser.add_argument("--tries", type=int, default=3)
    parser.add_argument("--keep", type=Path, help="folder for the run; one that is there is measured as it is")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.keep or Path(temporary) / "run"
        there = (folder / "metrics.json").exists()
        run = RunFolder(folder) if there else large_run(folder, given.demos, given.predicates, given.states)
        start = time.perf_counter()
        page = write_report(run)
        seconds = time.perf_counter() - start
        print(f"{given.demos} demonstrations of {given.states} states, {given.predicates} predicates")
        print(f"report: {page.stat().st_size / 1e6:.1f} MB, written in {seconds:.1f} s")
        for what, times in measure(page, given.tries).items():
            print(f"{what}: median {statistics.median(times):.0f} ms of {', '.join(f'{t:.0f}' for t in times)}")


if __name__ == "__main__":
    main()
