"""Third-party servers as processes of their own, and what the tests ask them."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from pix2pred.images import ShownPictures
from pix2pred.structs import Image, Picture
from pix2pred.structs.views import View
from pix2pred.vlm import FlowSettings, Purpose, Request
from pix2pred.vlm.hosted.client import HostedVLM
from pix2pred.vlm.hosted.openai_compatible import OpenAICompatible
from pix2pred.vlm.hosted.spec import hosted_model

QUIET = os.environ | {"OMP_NUM_THREADS": "1", "HF_HUB_OFFLINE": "1"}


@contextmanager
def serving(folder: Path, arguments: Callable[[int], Sequence[str | Path]]) -> Iterator[str]:
    """The address of a Python program that serves in ``folder`` on the port it is given in its arguments."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [sys.executable, *arguments(port)]
    with (folder / "log").open("wb") as log:
        server = subprocess.Popen(command, cwd=folder, env=QUIET, stdout=log, stderr=log)
        try:
            _wait(f"http://127.0.0.1:{port}/health", server, folder / "log")
            yield f"http://127.0.0.1:{port}/v1"
        finally:
            server.terminate()
            server.wait(30)


def _wait(address: str, server: subprocess.Popen[bytes], log: Path) -> None:
    for _ in range(1200):
        assert server.poll() is None, log.read_text()[-2000:]
        try:
            urllib.request.urlopen(address, timeout=30).close()
            return
        except OSError:
            time.sleep(0.25)
    raise AssertionError(log.read_text()[-2000:])


def ask(url: str, model: str = "tiny") -> HostedVLM:
    """The model behind a server."""
    return HostedVLM(hosted_model(OpenAICompatible(), f"{model}@{url}"), ShownPictures(), FlowSettings(timeout=120.0))


def view(shade: int, t: int) -> View:
    """A picture of a rectangle that stands out."""
    pixels = np.full((60, 80, 3), shade, dtype=np.uint8)
    pixels[10:40, 10:50] = 255 - shade
    return View(Picture("main", Image.from_pixels(pixels)), t, heading=f"state {t}, camera main")


REQUEST = Request(Purpose.LABEL, ("Before and after:", view(20, 0), view(220, 1), "\nPredicates:\nlit(a)"), 24)


def check_usage_and_pictures(url: str) -> None:
    """Answers come back with usage, are the same when asked again, and depend on every picture."""
    vlm = ask(url)
    answer = vlm.answer(REQUEST)
    assert answer.text and answer.spent.output_tokens > 0 and answer.spent.input_tokens > 40
    assert vlm.answer(REQUEST).text == answer.text, "greedy"
    others = [
        replace(REQUEST, parts=("Before and after:", first, second, REQUEST.parts[-1]))
        for first, second in ((view(220, 0), view(220, 1)), (view(20, 0), view(20, 1)), (view(220, 1), view(20, 0)))
    ]
    assert len({answer.text, *(vlm.answer(r).text for r in others)}) >= 3
