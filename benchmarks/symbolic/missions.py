"""Instances of the two space domains."""

from __future__ import annotations

from random import Random

from symbolic.instance import Instance


def satellite(rng: Random, large: bool) -> Instance:
    task = Instance()
    modes = task.add("mode", 3 if large else 2)
    directions = task.add("direction", 6 if large else 4)
    satellites = task.add("satellite", 2 if large else 1)
    for s in satellites:
        task.fact(f"pointing {s} {rng.choice(directions)}")
        instruments = task.add("instrument", rng.randint(2, 3) if large else 2)
        on = rng.choice(instruments) if rng.random() < 0.3 else None
        task.fact(f"power-on {on}" if on else f"power-available {s}")
        for instrument in instruments:
            task.fact(f"on-board {instrument} {s}", f"calibration-target {instrument} {rng.choice(directions)}")
            task.fact(*(f"supports {instrument} {m}" for m in rng.sample(modes, rng.randint(1, 2))))
    offered = sorted({a.split()[2] for a in task.init if a.startswith("supports")})
    pairs = [f"have-image {d} {m}" for d in directions for m in offered]
    task.goal = rng.sample(pairs, rng.randint(4, 6) if large else rng.randint(1, 2))
    if rng.random() < 0.4:
        task.goal.append(f"pointing {satellites[0]} {rng.choice(directions)}")
    return task


def rovers(rng: Random, large: bool) -> Instance:
    task = Instance()
    waypoints = task.add("waypoint", 6 if large else 4, "w")
    objectives = task.add("objective", 3 if large else 2)
    modes = task.add("mode", 2)
    task.fact(f"lander-at {task.add('lander', 1)[0]} {waypoints[0]}")
    task.connect(rng, "visible", waypoints, 3)
    visible = [a.split()[1:] for a in task.init if a.startswith("visible")]
    skills = ["analyses-soil", "analyses-rock"]
    for rover, store in zip(task.add("rover", 2 if large else 1), task.add("store", 2 if large else 1), strict=True):
        task.fact(f"at {rover} {rng.choice(waypoints)}", f"store-of {store} {rover}")
        task.fact(f"full {store}" if rng.random() < 0.3 else f"empty {store}")
        task.fact(*(f"passable {rover} {a} {b}" for a, b in visible))
        task.fact(*(f"{s} {rover}" for s in skills))
        camera = task.add("camera", 1)[0]
        task.fact(f"on-board {camera} {rover}", f"target {camera} {rng.choice(objectives)}")
        task.fact(*(f"supports {camera} {m}" for m in modes))
    for objective in objectives:
        task.fact(*(f"seen-from {objective} {w}" for w in rng.sample(waypoints, 2)))
    soils, rocks = rng.sample(waypoints, 3), rng.sample(waypoints, 3)
    task.fact(*(f"soil-at {w}" for w in soils), *(f"rock-at {w}" for w in rocks))
    wanted = [f"sent-soil {w}" for w in soils] + [f"sent-rock {w}" for w in rocks]
    images = [f"sent-image {o} {m}" for o in objectives for m in modes]
    task.goal = rng.sample(wanted, 3 if large else rng.randint(0, 2))
    task.goal += rng.sample(images, 2 if large else 1 if rng.random() < 0.6 or not task.goal else 0)
    return task
