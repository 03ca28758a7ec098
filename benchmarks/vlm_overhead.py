"""What asking a model costs on our side: CPU time of a store hit and of a live call.

    python benchmarks/vlm_overhead.py             all figures as one JSON object
    python benchmarks/vlm_overhead.py --calls 20  more repetitions

The server is on loopback, in another process. A live call has four pictures of 512 pixels that were never shown before,
noisy like photos; a labelling call has two, each whole and cropped, one of which the call before has shown. CPU time
depends on what else a machine does: the last figure, the time that SHA-256 of 100 MB takes, says how fast it was.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import multiprocessing
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from multiprocessing.synchronize import Event
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from pix2pred.images import ShownPictures
from pix2pred.registry import load_stored, load_vlm
from pix2pred.structs import Box, Image, Picture
from pix2pred.structs.views import View
from pix2pred.vlm import VLM, AnswerStore, Purpose, Request
from vlm.fault_server import FaultServer


def serve(seconds: float, places: int, started: Event, address: multiprocessing.Array) -> None:  # type: ignore[valid-type]
    with FaultServer(seconds=seconds, places=places).running() as server:
        address.value = server.url.encode()  # type: ignore[attr-defined]
        started.set()
        time.sleep(3600)


def with_server(work: Callable[[str], dict[str, float]], seconds: float = 0.0, places: int = 64) -> dict[str, float]:
    """What ``work`` gives for the address of a server in another process."""
    started, address = multiprocessing.Event(), multiprocessing.Array("c", 100)
    process = multiprocessing.Process(target=serve, args=(seconds, places, started, address), daemon=True)
    process.start()
    started.wait()
    try:
        return work(address.value.decode())  # type: ignore[attr-defined]
    finally:
        process.terminate()


def photo(seed: int, side: int = 512) -> Picture:
    """Smooth colours with a little noise: compresses about as well as a photo."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(0, 3, side), np.linspace(0, 3, side))
    waves = [127 + 90 * np.sin(x * rng.uniform(1, 4) + y * rng.uniform(1, 4)) for _ in range(3)]
    pixels = np.stack(waves, axis=-1) + rng.normal(0, 3, (side, side, 3))
    boxes = {f"object{i}": Box(60.0 * i, 40.0 * i, 60.0 * i + 80, 40.0 * i + 90) for i in range(6)}
    return Picture("main", Image.from_pixels(pixels.clip(0, 255).astype(np.uint8)), boxes)


def requests(count: int) -> list[Request]:
    """Labelling queries with four pictures of 512 pixels and a long history."""
    atoms = "\n".join(f"on(object{i % 6}, object{i % 5})" for i in range(60))
    history = "\n".join(f"* on(object{i % 6}, object{i % 5}): True. It rests there, as before." for i in range(60))
    made = []
    for n in range(count):
        views = [View(photo(4 * n + i), i, heading=f"state {i}, camera main") for i in range(4)]
        made.append(Request(Purpose.LABEL, (f"Question {n}\n{history}\nPredicates:\n{atoms}", *views), 4000))
    return made


def labelling(count: int) -> list[Request]:
    """Queries about one state after the other: before and after, whole and around the skill."""
    photos = [photo(1000 + n) for n in range(count + 1)]
    around = Box(100.0, 60.0, 400.0, 330.0)
    made = []
    for n in range(count):
        shown = [("before", photos[n], n), ("after", photos[n + 1], n + 1)]
        views = [View(p, t, crop, heading=f"{name}: {t}") for crop in (None, around) for name, p, t in shown]
        made.append(
            Request(Purpose.LABEL, (f"Question {n} of a row\n\nPredicates:\non(object1, object2)", *views), 4000)
        )
    return made


def milliseconds(vlm: VLM, asked: list[Request], clock: Callable[[], float]) -> float:
    took = []
    for request in asked:
        begin = clock()
        vlm.answer(request)
        took.append(1000 * (clock() - begin))
    return round(statistics.median(took), 2)


def overhead(url: str, calls: int) -> dict[str, float]:
    """CPU milliseconds of this process, the median of ``calls``; imports and the first connection left out."""
    asked = requests(calls + 1)
    with tempfile.TemporaryDirectory() as folder:
        spec = f"openai-compatible:tiny@{url}"
        bare = load_vlm(spec, None)
        bare.answer(asked[-1])
        live = milliseconds(load_stored(spec, None, AnswerStore(Path(folder))), asked[:-1], time.process_time)
        row = milliseconds(load_stored(spec, None, AnswerStore(Path(folder))), labelling(calls), time.process_time)
        hits = load_stored(spec, None, AnswerStore(Path(folder)))
        hits.answer(asked[0])
        return {
            "store_hit_cpu_ms": milliseconds(hits, asked[:-1], time.process_time),
            "live_call_cpu_ms": live,
            "labelling_call_cpu_ms": row,
            "of_a_live_call_drawing_and_encoding_four_pictures_cpu_ms": drawing(asked[:-1]),
            "sha256_of_100_MB_cpu_ms": hashing(),
        }


def hashing() -> float:
    begin = time.process_time()
    hashlib.sha256(bytes(100_000_000)).digest()
    return round(1000 * (time.process_time() - begin), 2)


def drawing(asked: list[Request]) -> float:
    took = []
    for request in asked:
        begin = time.process_time()
        draw = ShownPictures()
        for view in request.views:
            draw(view)
        took.append(1000 * (time.process_time() - begin))
    return round(statistics.median(took), 2)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--calls", type=int, default=20)
    calls = parser.parse_args().calls
    print(json.dumps(with_server(lambda url: overhead(url, calls)), indent=1))


if __name__ == "__main__":
    main()
