"""How long a picture of a MuJoCo domain takes, with both OpenGL backends, and whether it is the same every time.

    python benchmarks/rendering.py --frames 20

Every row is two processes of their own with ``MUJOCO_GL`` set. Both draw the same test scenes: a picture of 480 by 480
pixels (640 by 480 in Cleanup and Juice, six cameras in turn, a new room every sixth time) alone, and with the boxes of
its objects, which a second drawing of every geom's number finds. CPU seconds are of both. Ended quietly: both
processes ended with status 0 and wrote nothing to their error stream.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from statistics import median
from typing import Any

BACKENDS = ("egl", "osmesa")


Drawers = tuple[Callable[[], Any], Callable[[], Any]]
"""Two functions of a scene: draw it with boxes, and draw it alone. Both give the pixels."""


def coffee(index: int) -> Drawers:
    from pix2pred.domains.coffee.scenes import initial_world
    from pix2pred.domains.coffee.simulation.render import render, render_pixels
    from pix2pred.domains.seeds import Split, scene_generator

    world = initial_world(3, scene_generator(0, Split.TASKS, 3, index))
    return lambda: render(world).image.pixels(), lambda: render_pixels(world)


def kitchen(index: int) -> Drawers:
    from pix2pred.domains.kitchen.model import kitchen_camera
    from pix2pred.domains.kitchen.render import picture_of, simulation_of
    from pix2pred.domains.kitchen.scenes import RIGHT, start_world
    from pix2pred.domains.seeds import Split

    data = simulation_of(start_world(0, Split.TASKS, index, RIGHT))
    return lambda: picture_of(data).image.pixels(), lambda: kitchen_camera().pixels(data)


def home(name: str, index: int) -> Drawers:
    """The robot's six cameras in turn; every sixth picture is the first one of its room, which is made for it."""
    from pix2pred.domains.home.cameras import camera_names, picture, pixels_of
    from pix2pred.registry import load_domain

    world = load_domain(name).start("new-objects", 0, index // 6).world  # type: ignore[attr-defined]
    camera = camera_names(world)[index % 6]
    return lambda: picture(world, camera).image.pixels(), lambda: pixels_of(world, camera)


DOMAINS: dict[str, Callable[[int], Drawers]] = {
    "coffee": coffee, "kitchen": kitchen, "cleanup": partial(home, "cleanup"), "juice": partial(home, "juice"),
}  # fmt: skip


def draw(domain: str, frames: int) -> None:
    """What a process of its own does: prints seconds per frame and a digest of all pixels."""
    found: dict[str, Any] = {"with boxes": [], "alone": [], "cpu": [], "boxes cpu": []}
    digest = hashlib.sha256()
    begin = time.perf_counter()
    DOMAINS[domain](0)[0]()
    found["first"] = time.perf_counter() - begin
    for index in range(frames):
        for name, make in zip(("with boxes", "alone"), DOMAINS[domain](index), strict=True):
            begin, busy = time.perf_counter(), time.process_time()
            digest.update(make().tobytes())
            found[name].append(time.perf_counter() - begin)
            found["cpu" if name == "alone" else "boxes cpu"].append(time.process_time() - busy)
    medians = {name: median(found[name]) for name in found if name != "first"}
    print(json.dumps(medians | {"first": found["first"], "slowest": max(found["alone"]), "pixels": digest.hexdigest()}))


def row(domain: str, backend: str, frames: int) -> str:
    command = [sys.executable, __file__, "--child", domain, "--frames", str(frames)]
    runs = [
        subprocess.run(
            command, capture_output=True, text=True, check=False, timeout=600, env=os.environ | {"MUJOCO_GL": backend}
        )
        for _ in range(2)
    ]
    if any(r.returncode for r in runs):
        return f"| {domain} | {backend} | {next(r for r in runs if r.returncode).stderr.strip().splitlines()[-1]} |"
    one, other = (json.loads(r.stdout) for r in runs)
    best = {key: min(one[key], other[key]) for key in ("alone", "cpu", "slowest", "with boxes", "boxes cpu", "first")}
    same = "yes" if one["pixels"] == other["pixels"] else "NO"
    quiet = "NO" if any(r.stderr for r in runs) else "yes"
    return f"| {domain} | {backend} | {' | '.join(f'{v:.3f}' for v in best.values())} | {same} | {quiet} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=20, help="scenes per process")
    parser.add_argument("--domains", nargs="+", choices=DOMAINS, default=list(DOMAINS))
    parser.add_argument("--child", choices=DOMAINS, help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.child:
        draw(args.child, args.frames)
        return
    print(f"seconds, medians of {args.frames} scenes, the faster of two processes; 'first' includes setting up\n")
    titles = (
        "domain",
        "MUJOCO_GL",
        "picture",
        "CPU",
        "slowest",
        "with boxes",
        "CPU",
        "first",
        "equal pixels",
        "ended quietly",
    )
    print(f"| {' | '.join(titles)} |")
    print("|---" * len(titles) + "|")
    for domain in args.domains:
        for backend in BACKENDS:
            print(row(domain, backend, args.frames), flush=True)


if __name__ == "__main__":
    main()
