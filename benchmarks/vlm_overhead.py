"""What asking a model costs on our side: CPU time of a store hit and of a live call, and throughput of labelling.

    python benchmarks/vlm_overhead.py             all figures as one JSON object
    python benchmarks/vlm_overhead.py --calls 20  more repetitions

The server is on loopback; its own time is spent in another process for the CPU figures. Throughput: 12 demonstrations
of 4 skills, a server that takes one second an answer and allows 16 at once; the longest chain of dependent queries is
1 proposal, 1 first state, and 4 states with a double check each: 10 seconds.
"""

from __future__ import annotations

import argparse
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
from pix2pred.predicates import Labeller, LabelSettings, ProposalSettings, label_demos, lift, propose
from pix2pred.registry import load_stored, load_vlm
from pix2pred.structs import Box, Demo, Image, Picture, State
from pix2pred.structs.views import View
from pix2pred.vlm import VLM, AnswerStore, FlowSettings, Request
from predicates.scripted import demo
from vlm.fault_server import FaultServer


def serve(seconds: float, places: int, started: Event, address: multiprocessing.Array) -> None:  # type: ignore[valid-type]
    with FaultServer(seconds=seconds, places=places).running() as server:
        address.value = server.url.encode()  # type: ignore[attr-defined]
        started.set()
        time.sleep(600)


def with_server(seconds: float, places: int, work: Callable[[str], dict[str, float]]) -> dict[str, float]:
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
        made.append(Request("label", (f"Question {n}\n{history}\nPredicates:\n{atoms}", *views), 4000))
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
        hits = load_stored(spec, None, AnswerStore(Path(folder)))
        hits.answer(asked[0])
        return {
            "store_hit_cpu_ms": milliseconds(hits, asked[:-1], time.process_time),
            "live_call_cpu_ms": live,
            "of_it_drawing_and_encoding_four_pictures_cpu_ms": drawing(asked[:-1]),
        }


def drawing(asked: list[Request]) -> float:
    took = []
    for request in asked:
        begin = time.process_time()
        draw = ShownPictures()
        for view in request.views:
            draw(view)
        took.append(1000 * (time.process_time() - begin))
    return round(statistics.median(took), 2)


def throughput(url: str) -> dict[str, float]:
    """Seconds of proposing and labelling, against the longest chain of dependent queries."""
    skills = 4
    demos = []
    for d in range(12):
        one = demo(actions=skills, name=f"demo-{d}")
        states = tuple(State((photo(100 * d + t),)) for t in range(skills + 1))
        demos.append(Demo(one.name, one.objects, states, one.actions, one.goal))
    with tempfile.TemporaryDirectory() as folder:
        flow = FlowSettings(concurrent=16)
        vlm = load_stored(f"openai-compatible:tiny@{url}", None, AnswerStore(Path(folder)), flow=flow)
        load_vlm(f"openai-compatible:tiny@{url}", None).answer(Request("warm", ("Hello",), 10))
        begin = time.perf_counter()
        proposals = propose(demos, vlm, ProposalSettings(), jobs=flow.concurrent)
        label_demos(demos, (), lift(proposals), Labeller(vlm, LabelSettings()), jobs=flow.concurrent)
        took = time.perf_counter() - begin
    chain = 1.0 + 1.0 + 2.0 * skills
    return {"labelling_s": round(took, 2), "longest_chain_s": chain, "ratio": round(took / chain, 3)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--calls", type=int, default=20)
    calls = parser.parse_args().calls
    figures = with_server(0.0, 64, lambda url: overhead(url, calls))
    figures |= with_server(1.0, 16, throughput)
    print(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main()
