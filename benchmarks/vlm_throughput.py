"""How long labelling takes beside the longest chain of dependent queries, with a server of fixed answering time.

    python benchmarks/vlm_throughput.py                   12 rendered demonstrations of More Stacks
    python benchmarks/vlm_throughput.py --pictures photos 12 of noisy pictures that hardly compress
    python benchmarks/vlm_throughput.py --seconds 2 --places 8

Every request takes ``--seconds`` from its arrival, ``--places`` at once. A demonstration of k skills is a chain of one
proposal, one first state and two queries for each later state; the labelling of every demonstration waits for all
proposals. Printed as one JSON object: seconds, the longest chain, their ratio, and this process's CPU seconds.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from pix2pred.predicates import Labeller, LabelSettings, ProposalSettings, label_demos, lift, propose
from pix2pred.registry import load_domain, load_stored, load_vlm
from pix2pred.structs import Demo, State
from pix2pred.vlm import AnswerStore, FlowSettings, Purpose, Request, Together
from predicates.scripted import demo
from vlm_overhead import photo, with_server


def rendered() -> list[Demo]:
    """12 demonstrations of the burger domain, one of them twice as long as the others."""
    return list(load_domain("burger").demonstrations("more-stacks", 0))


def photos(skills: int = 4) -> list[Demo]:
    """12 short demonstrations of pictures with the noise of a camera."""
    demos = []
    for d in range(12):
        one = demo(actions=skills, name=f"demo-{d}")
        states = tuple(State((photo(100 * d + t),)) for t in range(skills + 1))
        demos.append(Demo(one.name, one.objects, states, one.actions, one.goal))
    return demos


def measure(url: str, demos: Sequence[Demo], seconds: float, places: int) -> dict[str, float]:
    flow = FlowSettings(concurrent=places)
    model = f"openai-compatible:tiny@{url}"
    with tempfile.TemporaryDirectory() as folder:
        vlm = load_stored(model, None, AnswerStore(Path(folder)), flow=flow)
        load_vlm(model, None).answer(Request(Purpose.DOCTOR, ("Hello",), 10))  # imports
        begin, cpu = time.perf_counter(), time.process_time()
        proposals = propose(demos, vlm, ProposalSettings(), together=Together(places))
        label_demos(demos, (), lift(proposals), Labeller(vlm, LabelSettings(), Together(places)))
        took, cpu = time.perf_counter() - begin, time.process_time() - cpu
    chain = seconds * (2 + 2 * max(len(d.actions) for d in demos))
    return {
        "demonstrations": len(demos),
        "queries": sum(2 + 2 * len(d.actions) for d in demos),
        "seconds": round(took, 2),
        "longest_chain_s": chain,
        "ratio": round(took / chain, 3),
        "own_cpu_s": round(cpu, 2),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pictures", choices=("rendered", "photos"), default="rendered")
    parser.add_argument("--seconds", type=float, default=1.0, help="that an answer takes")
    parser.add_argument("--places", type=int, default=16, help="answers at once")
    options = parser.parse_args()
    demos = rendered() if options.pictures == "rendered" else photos()
    figures = with_server(
        lambda url: measure(url, demos, options.seconds, options.places), options.seconds, options.places
    )
    print(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main()
