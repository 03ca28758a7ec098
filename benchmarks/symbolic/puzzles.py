"""Instances of domains on grids and one-way walks."""

from __future__ import annotations

from itertools import pairwise
from random import Random

from symbolic.instance import Instance


def npuzzle(rng: Random, large: bool) -> Instance:
    task = Instance()
    columns, rows = (3, 3) if large else rng.choice(((3, 2), (2, 2), (3, 3)))
    cells = task.grid(columns, rows)
    tiles = task.add("tile", columns * rows - 1)
    content: dict[tuple[int, int], str] = dict(zip(cells, tiles, strict=False))
    gap = next(cell for cell in cells if cell not in content)
    task.goal = [f"at {tile} {cells[cell]}" for cell, tile in content.items()]
    for _ in range(rng.randint(30, 60) if large else rng.randint(4, 12)):
        x, y = gap
        near = rng.choice([c for c in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)) if c in cells])
        content[gap] = content.pop(near)
        gap = near
    task.fact(f"gap {cells[gap]}", *(f"at {tile} {cells[cell]}" for cell, tile in sorted(content.items())))
    return task


def visitall(rng: Random, large: bool) -> Instance:
    task = Instance()
    cells = list(task.grid(*((4, rng.randint(4, 5)) if large else (rng.randint(2, 3), rng.randint(2, 3)))).values())
    start, *others = rng.sample(cells, len(cells))
    task.fact(f"robot-at {start}", f"visited {start}")
    task.goal = [f"visited {c}" for c in others[: len(others) * 3 // 4]]
    return task


def keys(rng: Random, large: bool) -> Instance:
    task = Instance()
    cells = task.grid(*((5, 3) if large else (rng.randint(2, 3), 2)))
    shapes = task.add("shape", 2)
    held = task.add("key", 3 if large else rng.randint(1, 2))
    locked = rng.sample(sorted(cells.values()), 3 if large else rng.randint(0, 2))
    free = [c for c in cells.values() if c not in locked]
    task.fact(*(f"locked {c}" for c in locked), *(f"open {c}" for c in free))
    task.fact(*(f"lock-shape {c} {rng.choice(shapes)}" for c in locked))
    task.fact(f"robot-at {rng.choice(free)}")
    carried = held[0] if rng.random() < 0.3 else None
    task.fact(f"holding {carried}" if carried else "arm-empty")
    for key in held:
        task.fact(f"key-shape {key} {rng.choice(shapes)}")
        if key != carried:
            task.fact(f"key-at {key} {rng.choice(free)}")
    for key in rng.sample(held, 2 if large else rng.randint(1, len(held))):
        task.goal.append(f"key-at {key} {rng.choice(locked or free)}")
    return task


def sokoban(rng: Random, large: bool) -> Instance:
    task = Instance()
    columns, rows = (5, 5) if large else (rng.randint(3, 4), 3)
    cells = task.grid(columns, rows)
    for x, y in cells:
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            line = [(x + i * dx, y + i * dy) for i in range(3)]
            if all(c in cells for c in line):
                task.fact(f"in-line {' '.join(cells[c] for c in line)}")
    inner = sorted(cells[c] for c in cells if 0 < c[0] < columns - 1 and 0 < c[1] < rows - 1)
    boxes = task.add("box", rng.randint(2, 3) if large else rng.randint(1, min(2, len(inner))))
    starts = rng.sample(inner, len(boxes))
    keeper = rng.choice([c for c in sorted(cells.values()) if c not in starts])
    task.fact(f"keeper-at {keeper}", *(f"box-at {b} {c}" for b, c in zip(boxes, starts, strict=True)))
    task.fact(*(f"vacant {c}" for c in cells.values() if c not in starts and c != keeper))
    ends = rng.sample(sorted(cells.values()), len(boxes))
    task.goal = [f"box-at {b} {c}" for b, c in zip(boxes, ends, strict=True)]
    return task


def spanner(rng: Random, large: bool) -> Instance:
    task = Instance()
    shed, gate = task.add("place", 1, "shed") + task.add("place", 1, "gate")
    way = [shed, *task.add("place", rng.randint(3, 5) if large else rng.randint(1, 2), "stop"), gate]
    task.fact(*(f"link {a} {b}" for a, b in pairwise(way)))
    nuts = task.add("nut", rng.randint(3, 4) if large else rng.randint(1, 3))
    tools = task.add("spanner", len(nuts) + rng.randint(0, 1))
    task.fact(f"at {task.add('mechanic', 1)[0]} {shed}", *(f"usable {s}" for s in tools))
    task.fact(*(f"at {s} {rng.choice(way[:-1])}" for s in tools))
    for nut in nuts:
        task.fact(f"at {nut} {gate}", f"loose {nut}")
        task.goal.append(f"tightened {nut}")
    return task
