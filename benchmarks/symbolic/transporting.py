"""Instances of domains about moving things and people between places."""

from __future__ import annotations

from itertools import pairwise
from random import Random

from symbolic.instance import Instance


def ferry(rng: Random, large: bool) -> Instance:
    task = Instance()
    ports = task.add("port", rng.randint(4, 6) if large else rng.randint(2, 4))
    cars = task.add("car", rng.randint(4, 7) if large else rng.randint(1, 3))
    task.fact("empty-ferry", f"at-ferry {rng.choice(ports)}")
    for car in cars:
        start, end = rng.sample(ports, 2)
        task.fact(f"at {car} {start}")
        task.goal.append(f"at {car} {end}")
    return task


def logistics(rng: Random, large: bool) -> Instance:
    task = Instance()
    cities = task.add("city", 3 if large else 2)
    airports, places = [], []
    for city in cities:
        local = task.add("airport", 1) + task.add("place", 2 if large else rng.randint(1, 2))
        airports.append(local[0])
        places += local
        task.fact(*(f"in-city {p} {city}" for p in local), f"at {task.add('truck', 1)[0]} {rng.choice(local)}")
    task.fact(*(f"at {a} {rng.choice(airports)}" for a in task.add("plane", rng.randint(1, 2))))
    for package in task.add("package", rng.randint(3, 5) if large else rng.randint(1, 2)):
        start, end = rng.sample(places, 2)
        task.fact(f"at {package} {start}")
        task.goal.append(f"at {package} {end}")
    return task


def miconic(rng: Random, large: bool) -> Instance:
    task = Instance()
    floors = task.add("floor", rng.randint(6, 9) if large else rng.randint(3, 5))
    for i, low in enumerate(floors):
        task.fact(*(f"above {low} {high}" for high in floors[i + 1 :]))
    task.fact(f"lift-at {rng.choice(floors)}")
    for passenger in task.add("passenger", rng.randint(5, 8) if large else rng.randint(1, 3)):
        start, end = rng.sample(floors, 2)
        task.fact(f"origin {passenger} {start}", f"destination {passenger} {end}")
        task.goal.append(f"served {passenger}")
    return task


def driverlog(rng: Random, large: bool) -> Instance:
    task = Instance()
    places = task.add("place", 5 if large else 3)
    task.connect(rng, "road", places, 2 if large else 1)
    task.connect(rng, "path", places, 1)
    trucks = task.add("truck", 2 if large else rng.randint(1, 2))
    drivers = task.add("driver", 2 if large else rng.randint(1, 2))
    for x in trucks + drivers:
        task.fact(f"at {x} {rng.choice(places)}")
    task.fact(*(f"empty {t}" for t in trucks))
    for parcel in task.add("parcel", rng.randint(3, 5) if large else 1):
        start, end = rng.sample(places, 2)
        task.fact(f"at {parcel} {start}")
        task.goal.append(f"at {parcel} {end}")
    if large or rng.random() < 0.6:
        task.goal.append(f"at {drivers[0]} {rng.choice(places)}")
    return task


def zenotravel(rng: Random, large: bool) -> Instance:
    task = Instance()
    cities = task.add("city", rng.randint(4, 5) if large else 3)
    levels = task.add("level", 4 if large else 3)
    task.fact(*(f"next {a} {b}" for a, b in pairwise(levels)))
    planes = task.add("aircraft", 2 if large else rng.randint(1, 2))
    for plane in planes:
        task.fact(f"at {plane} {rng.choice(cities)}", f"fuel {plane} {rng.choice(levels[:-1])}")
    for person in task.add("person", rng.randint(4, 6) if large else rng.randint(1, 2)):
        start, end = rng.sample(cities, 2)
        task.fact(f"at {person} {start}")
        task.goal.append(f"at {person} {end}")
    if rng.random() < 0.4:
        task.goal.append(f"at {planes[0]} {rng.choice(cities)}")
    return task


def transport(rng: Random, large: bool) -> Instance:
    task = Instance()
    places = task.add("place", rng.randint(5, 6) if large else rng.randint(3, 4))
    task.connect(rng, "road", places, 2 if large else 0)
    sizes = task.add("size", 3)
    task.fact(*(f"one-less {a} {b}" for a, b in pairwise(sizes)))
    for vehicle in task.add("vehicle", 2 if large else 1):
        task.fact(f"at {vehicle} {rng.choice(places)}", f"capacity {vehicle} {rng.choice(sizes[1:])}")
    for package in task.add("package", rng.randint(4, 6) if large else rng.randint(1, 3)):
        start, end = rng.sample(places, 2)
        task.fact(f"at {package} {start}")
        task.goal.append(f"at {package} {end}")
    return task


def parking(rng: Random, large: bool) -> Instance:
    task = Instance()
    cars = task.add("car", rng.randint(5, 6) if large else rng.randint(3, 4))
    kerbs = task.add("kerb", len(cars) - 1 if large else len(cars) - rng.randint(0, 1))
    front: dict[str, str | None] = dict.fromkeys(kerbs)
    rear: dict[str, str | None] = dict.fromkeys(kerbs)
    for car in cars:
        kerb = rng.choice([k for k in kerbs if rear[k] is None])
        (rear if front[kerb] else front)[kerb] = car
    for kerb in kerbs:
        first, second = front[kerb], rear[kerb]
        if first is None:
            task.fact(f"kerb-clear {kerb}")
            continue
        task.fact(f"parked {first} {kerb}", f"at-kerb {first}")
        task.fact(*((f"behind {second} {first}", f"car-clear {second}") if second else (f"car-clear {first}",)))
    chosen = rng.sample(cars, len(cars) if large else 2)
    fronts, rears = chosen[: (len(chosen) + 1) // 2], chosen[(len(chosen) + 1) // 2 :]
    goal_kerbs = rng.sample(kerbs, len(fronts))
    task.goal += [f"parked {c} {k}" for c, k in zip(fronts, goal_kerbs, strict=True)]
    task.goal += [f"behind {c} {f}" for c, f in zip(rears, fronts, strict=False)]
    return task
