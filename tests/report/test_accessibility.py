"""The pages can be used without a mouse, without colours and with a screen reader: axe-core finds nothing serious."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from browser import chromium
from cli.hostile_lamps import Fake, OneModel, sees
from extras import need
from lamps_run import BOMB, learn_lamps
from pix2pred.cli.app import run as command
from pix2pred.images import ShownPictures
from pix2pred.report import REPORT
from pix2pred.review import MailboxServer, ReviewServer
from pix2pred.runs.folder import RunFolder
from pix2pred.vlm.mailbox import MailboxVLM
from pix2pred.vlm.mailbox_folder import MailboxFolder
from vlm.test_mailbox import QUESTION, asking, awaited

pytestmark = need("playwright", "axe_playwright_python", extra="browser")

GRAVE = ("serious", "critical")
Opened = Callable[[Any, RunFolder], None]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as made:
        yield made


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    """A learned run with a report and the page of a plan."""
    folder = learn_lamps(tmp_path_factory.mktemp("lamps"), "run", demos=3)
    task = folder.path.parent / "data/tasks/t0"
    assert command(["plan", str(folder.path), "--task", str(task)], OneModel(Fake(sees, sees, f"fake{BOMB}"))) == 0
    return folder


@contextmanager
def _report(run: RunFolder) -> Iterator[str]:
    yield (run.path / REPORT).resolve().as_uri()


@contextmanager
def _plan(run: RunFolder) -> Iterator[str]:
    yield (run.path / "plans/t0/plan.html").resolve().as_uri()


@contextmanager
def _review(run: RunFolder) -> Iterator[str]:
    with ReviewServer(run) as server:
        threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True).start()
        yield server.url
        server.shutdown()


@contextmanager
def _mailbox(run: RunFolder) -> Iterator[str]:
    folder = run.path.parent / "mailbox"
    box = MailboxVLM(folder, ShownPictures(), poll=0.01)
    asking(box, QUESTION, [])
    awaited(folder, "d0-*/request.json")
    with MailboxServer(MailboxFolder(folder)) as server:
        threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True).start()
        yield server.url
        server.shutdown()
    box.stop()


def _faults(page: Any) -> list[str]:
    """What axe-core calls serious or worse, a line an element."""
    from axe_playwright_python.sync_playwright import Axe

    found = Axe().run(page).response["violations"]
    return [
        f"{fault['id']} ({fault['impact']}): {fault['help']}: {node['html'][:200]}"
        for fault in found
        if fault["impact"] in GRAVE
        for node in fault["nodes"]
    ]


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("opened", [_report, _plan, _review, _mailbox])
def test_nothing_serious_is_found(browser: Any, run: RunFolder, opened: Any, scheme: str) -> None:
    context = browser.new_context(viewport={"width": 1280, "height": 800}, color_scheme=scheme)
    page = context.new_page()
    page.set_default_timeout(60_000)
    with opened(run) as address:
        page.goto(address)
        page.wait_for_load_state("networkidle")
        for details in page.locator("details").all():
            details.evaluate("x => { x.open = true }")
        assert _faults(page) == []
    context.close()


def test_a_fault_would_be_found(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "page.html"
    path.write_text("<html lang=en><title>t</title><main><h1>t</h1><img src='data:,'><button></button></main></html>")
    page = browser.new_page()
    page.goto(path.as_uri())
    assert {fault.partition(" ")[0] for fault in _faults(page)} == {"image-alt", "button-name"}
    page.close()
