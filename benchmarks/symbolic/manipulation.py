"""Instances of domains about hands and stacks."""

from __future__ import annotations

from itertools import pairwise
from random import Random

from symbolic.instance import Instance, towers


def blocksworld(rng: Random, large: bool) -> Instance:
    task = Instance()
    blocks = task.add("block", rng.randint(7, 9) if large else rng.randint(3, 5), "b")
    task.fact("hand-empty")
    for pile in towers(rng, blocks):
        task.fact(f"on-table {pile[0]}", f"clear {pile[-1]}")
        task.fact(*(f"on {b} {a}" for a, b in pairwise(pile)))
    for pile in towers(rng, blocks):
        task.goal += [f"on {b} {a}" for a, b in pairwise(pile)]
        if len(pile) == 1:
            task.goal.append(f"on-table {pile[0]}")
    return task


def gripper(rng: Random, large: bool) -> Instance:
    task = Instance()
    rooms = task.add("room", rng.randint(3, 4) if large else rng.randint(2, 3))
    balls = task.add("ball", rng.randint(5, 8) if large else rng.randint(1, 3))
    hands = task.add("gripper", rng.randint(1, 2))
    task.fact(f"at-robot {rng.choice(rooms)}", *(f"free {g}" for g in hands))
    for ball in balls:
        start, end = rng.sample(rooms, 2)
        task.fact(f"at {ball} {start}")
        task.goal.append(f"at {ball} {end}")
    return task


def hanoi(rng: Random, large: bool) -> Instance:
    task = Instance()
    discs = task.add("disc", 5 if large else rng.randint(2, 4))
    pegs = task.add("peg", 3)
    for i, disc in enumerate(discs):
        task.fact(*(f"smaller {disc} {other}" for other in (*discs[i + 1 :], *pegs)))
    for target, facts in ((task.init, True), (task.goal, False)):
        place = {disc: rng.choice(pegs) for disc in discs}
        top = {peg: peg for peg in pegs}
        for disc in reversed(discs):
            target.append(f"on {disc} {top[place[disc]]}")
            top[place[disc]] = disc
        if facts:
            target += [f"clear {spot}" for spot in top.values()]
    return task


def depots(rng: Random, large: bool) -> Instance:
    task = Instance()
    places = task.add("depot", 1) + task.add("shop", 2 if large else rng.randint(1, 2))
    crates = task.add("crate", rng.randint(4, 5) if large else rng.randint(2, 3))
    trucks = task.add("truck", 2 if large else 1)
    pallets = task.add("pallet", len(places) + 1)
    where = dict(zip(pallets, [*places, rng.choice(places)], strict=True))
    for place, hoist in zip(places, task.add("hoist", len(places)), strict=True):
        task.fact(f"hoist-at {hoist} {place}", f"available {hoist}")
    task.fact(*(f"truck-at {t} {rng.choice(places)}" for t in trucks))
    top = {p: p for p in pallets}
    for crate in crates:
        base = rng.choice(pallets)
        task.fact(f"on {crate} {top[base]}", f"surface-at {crate} {where[base]}")
        top[base] = crate
    task.fact(*(f"surface-at {p} {where[p]}" for p in pallets), *(f"clear {s}" for s in top.values()))
    goal_top = {p: p for p in pallets}
    for crate in rng.sample(crates, len(crates) if large else rng.randint(1, 2)):
        base = rng.choice(pallets)
        task.goal.append(f"on {crate} {goal_top[base]}")
        goal_top[base] = crate
    return task


def bartender(rng: Random, large: bool) -> Instance:
    task = Instance()
    hands = task.add("hand", 2)
    ingredients = task.add("ingredient", 3)
    cocktails = task.add("cocktail", 3 if large else 2)
    glasses = task.add("glass", rng.randint(3, 5) if large else rng.randint(1, 2))
    shakers = task.add("shaker", 1)
    held = dict(zip(hands, rng.sample(glasses + shakers, rng.choice((0, 0, 1, 2))), strict=False))
    task.fact(*(f"holding {h} {held[h]}" if h in held else f"free {h}" for h in hands))
    task.fact(*(f"on-bar {v}" for v in glasses + shakers if v not in held.values()))
    task.fact(*(f"void {s}" for s in shakers), *(f"clean {g}" for g in glasses))
    for ingredient, tap in zip(ingredients, task.add("dispenser", 3), strict=True):
        task.fact(f"dispenses {tap} {ingredient}")
    for cocktail in cocktails:
        first, second = rng.sample(ingredients, 2)
        task.fact(f"first-part {cocktail} {first}", f"second-part {cocktail} {second}")
    drinks = [rng.choice(cocktails)] + [rng.choice(cocktails + ingredients) for _ in glasses[1:]]
    if not large:
        drinks = [rng.choice(cocktails)] if rng.random() < 0.7 else rng.sample(ingredients, len(glasses))
        if rng.random() < 0.4:
            task.init = [f"dirty {glasses[0]}" if a == f"clean {glasses[0]}" else a for a in task.init]
    task.goal = [f"contains {g} {d}" for g, d in zip(glasses, drinks, strict=False)]
    return task


def childsnack(rng: Random, large: bool) -> Instance:
    task = Instance()
    children = task.add("child", rng.randint(3, 4) if large else rng.randint(1, 2))
    places = task.add("place", 3 if large else 2, "table") + task.add("place", 1, "kitchen")
    trays = task.add("tray", rng.randint(1, 2))
    spare = rng.randint(0, 1)
    breads, fillings = task.add("bread", len(children) + spare), task.add("filling", len(children) + spare)
    task.fact(*(f"fresh {s}" for s in task.add("sandwich", len(children) + spare)))
    task.fact(*(f"bread-left {b}" for b in breads), *(f"filling-left {f}" for f in fillings))
    task.fact("kitchen kitchen1", *(f"tray-at {t} {rng.choice(places)}" for t in trays))
    allergic = [c for c in children if rng.random() < 0.5]
    for child in children:
        task.fact(f"waiting {child} {rng.choice(places[:-1])}")
        task.fact(f"{'allergic' if child in allergic else 'hardy'} {child}")
        task.goal.append(f"served {child}")
    task.fact(*(f"free-bread {b}" for b in rng.sample(breads, len(allergic))))
    task.fact(*(f"free-filling {f}" for f in rng.sample(fillings, len(allergic))))
    return task
