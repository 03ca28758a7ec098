"""The demonstrations and the test families (method 10.5, 11.1)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from pix2pred.domains.home.domain import Recipe, Start, StartMaker
from pix2pred.domains.home.world import Body
from pix2pred.domains.juice.party import BANQUET, PartyCup, PartyJuicer, lay_out
from pix2pred.domains.juice.scenes import JUICER, Cup, Plan, make_world

Rng = np.random.Generator

DEMONSTRATED_FRUITS = ("apple", "orange")
NEW_FRUITS = ("lime", "plum", "lemon")
JUICE_CUPS = ("glass", "mug", "plastic_cup", "tumbler")
WASTE_CUPS = ("plastic_cup", "tumbler")
DRINKS = ("coffee", "cola", "tea")


def _shown(name: str, plan: Plan, skills: Sequence[str], goal: Sequence[str]) -> Recipe:
    return Recipe(name, partial(make_world, plan, Body.HUMAN, "home"), tuple(skills), tuple(goal))


def _in(fruit: str) -> list[str]:
    return [f"PickMovable({fruit})", f"PlaceInside({fruit}, {JUICER})"]


def _run(juice_cup: str, waste_cup: str) -> str:
    return f"TurnOnAndRunMachine({JUICER}, {juice_cup}, {waste_cup})"


def _to(side: str, cup: str) -> list[str]:
    return [f"PickContainer({cup})", f"PlaceInside{side}ValveRegion({cup}, {JUICER})"]


def _emptied(cup: str) -> list[str]:
    return [f"PickContainer({cup})", f"DumpFromOneIntoOther({cup}, bowl)"]


CLOSE = f"CloseLid({JUICER})"
_BOTH = {"blue_cup": Cup("plastic_cup", "juice"), "clear_cup": Cup("tumbler", "waste")}

RECIPES: Sequence[Recipe] = (
    _shown("run-0", Plan(_BOTH, ("orange",), ("orange",), gaze=JUICER),
           [CLOSE, _run("blue_cup", "clear_cup")], ["JuiceInCup(orange, blue_cup)"]),
    _shown("run-1", Plan({"mug": Cup("mug"), "plastic_cup": Cup("plastic_cup", "waste")}, ("orange",), ("orange",),
                         gaze=JUICER),
           [CLOSE, *_to("Juice", "mug"), _run("mug", "plastic_cup")], ["JuiceInCup(orange, mug)"]),
    _shown("run-2", Plan({"plastic_cup": Cup("plastic_cup", "juice"), "wine_glass": Cup("glass")}, ("orange",),
                         ("orange",), opened=False, gaze="plastic_cup"),
           [*_to("Waste", "plastic_cup"), *_to("Juice", "wine_glass"), _run("wine_glass", "plastic_cup")],
           ["JuiceInCup(orange, wine_glass)"]),
    _shown("empty-0", Plan({"bowl": Cup("bowl"), "clear_cup": Cup("tumbler", "waste", ("coffee",))}, gaze="clear_cup"),
           _emptied("clear_cup"), ["Empty(clear_cup)"]),
    _shown("empty-1", Plan({"bowl": Cup("bowl"), "blue_cup": Cup("plastic_cup", contents=("orange",))}, ("orange",),
                           squeezed=("orange",), gaze="blue_cup"),
           _emptied("blue_cup"), ["Empty(blue_cup)"]),
    _shown("run-4", Plan({"blue_glass": Cup("glass", "juice"), "clear_cup": Cup("tumbler", "waste")}, ("orange",),
                         gaze="orange"),
           [*_in("orange"), CLOSE, _run("blue_glass", "clear_cup")], ["JuiceInCup(orange, blue_glass)"]),
    _shown("run-3", Plan({"blue_cup": Cup("plastic_cup", "juice"), "red_cup": Cup("plastic_cup", "waste")}, ("lemon",),
                         gaze="lemon"),
           [*_in("lemon"), CLOSE, _run("blue_cup", "red_cup")], ["JuiceInCup(lemon, blue_cup)"]),
    _shown("run-5", Plan({"blue_cup": Cup("plastic_cup", "juice"), "bowl": Cup("bowl"),
                          "clear_cup": Cup("tumbler", contents=("tea",))}, ("apple",), gaze="clear_cup"),
           [*_emptied("clear_cup"), f"PlaceInsideWasteValveRegion(clear_cup, {JUICER})", *_in("apple"), CLOSE,
            _run("blue_cup", "clear_cup")], ["JuiceInCup(apple, blue_cup)"]),
    _shown("place-0", Plan(_BOTH, ("apple",), powered=False, gaze="apple"),
           _in("apple"), [f"Inside(apple, {JUICER})"]),
    _shown("run-6", Plan({"blue_mug": Cup("mug"), "red_cup": Cup("plastic_cup", "waste")}, ("apple",), gaze="apple"),
           [*_in("apple"), CLOSE, *_to("Juice", "blue_mug"), _run("blue_mug", "red_cup")],
           ["JuiceInCup(apple, blue_mug)"]),
)  # fmt: skip
"""Seven times fruit is juiced, with a cup missing or full at first; three show only emptying a cup or placing fruit.

Taking a cup out of a region, and emptying juice whose fruit is there, are shown once or twice and pruned (method 5.5).
The juicer of ``place-0`` has no power.
"""


def _pick(choices: Sequence[str], rng: Rng) -> str:
    return str(choices[int(rng.integers(len(choices)))])


def _task(plan: Plan, fruit: str, style: str, rng: Rng) -> Start:
    return Start(make_world(plan, Body.ROBOT, style, rng), (f"JuiceInCup({fruit}, juice_cup)",))


def _like_demonstrations(fruits: Sequence[str], style: str) -> StartMaker:
    """In turn: everything in place; no cup under the juice valve; the cup for the waste is full and aside."""

    def start(index: int, rng: Rng) -> Start:
        fruit = _pick(fruits, rng)
        juice, waste = Cup(_pick(JUICE_CUPS, rng), "juice"), Cup(_pick(WASTE_CUPS, rng), "waste")
        cups = {"juice_cup": juice, "waste_cup": waste, "bowl": Cup("bowl")}
        if index % 3 == 1:
            cups["juice_cup"] = Cup(juice.kind)
        elif index % 3 == 2:
            cups["waste_cup"] = Cup(waste.kind, contents=(_pick(DRINKS, rng),))
        return _task(Plan(cups, (fruit,)), fruit, style, rng)

    return start


def _more_objects(index: int, rng: Rng) -> Start:
    """One or two fruits are in the juicer already."""
    kinds = [str(k) for k in rng.permutation((*DEMONSTRATED_FRUITS, *NEW_FRUITS))[: 2 + index % 2]]
    cups = {"juice_cup": Cup(_pick(JUICE_CUPS, rng), "juice"), "waste_cup": Cup(_pick(WASTE_CUPS, rng), "waste")}
    return _task(Plan(cups, kinds, kinds[1:]), kinds[0], "office", rng)


def _no_waste_cup(index: int, rng: Rng) -> Start:
    """No cup under the waste valve, no fruit inside."""
    fruit = _pick(NEW_FRUITS, rng)
    cups = {"juice_cup": Cup(_pick(JUICE_CUPS, rng), "juice"), "waste_cup": Cup(_pick(WASTE_CUPS, rng))}
    return _task(Plan(cups, (fruit,)), fruit, "office", rng)


def _full_juice_cup(index: int, rng: Rng) -> Start:
    """Both cups are in place, but the one for the juice is full.

    Were it the one for the waste, a plan could be wrong though the model is the printed one: its operators do not say
    that a cup leaves its region when it is taken, so that one of two shortest plans puts it under the other valve.
    """
    fruit = _pick(NEW_FRUITS, rng)
    juice = Cup(_pick(WASTE_CUPS, rng), "juice", (_pick(DRINKS, rng),))
    cups = {"juice_cup": juice, "waste_cup": Cup(_pick(WASTE_CUPS, rng), "waste"), "bowl": Cup("bowl")}
    return _task(Plan(cups, (fruit,)), fruit, "office", rng)


FULL_AT_FIRST = 3
"""Cups of a party that hold something else at first."""


def _party(index: int, rng: Rng) -> Start:
    """Five juices at five open juicers, all fruit outside; one cup for the waste is shared, and is empty at the end.

    For each juice the fruit is put in and the lid closed, both cups are brought and the machine is run; the cup for
    the waste is emptied before and after, and three of those for the juice once, each time into another bowl. The
    printed operators can need ten skills a juice and no more. Nothing stands in a region at first: that a cup leaves
    its region is not known to them. No cup is of clear glass: through one, the tape of a region behind it looks like
    juice.
    """
    fruits = [str(k) for k in rng.permutation((*DEMONSTRATED_FRUITS, *NEW_FRUITS))]
    machines = [PartyJuicer(opened=True, place=int(k)) for k in rng.permutation(len(fruits))]
    vessels = [PartyCup("waste_cup", "plastic_cup", (_pick(DRINKS, rng),))]
    for k, fruit in enumerate(fruits):
        full = k < FULL_AT_FIRST
        kind = _pick(WASTE_CUPS, rng) if full else "mug"
        vessels.append(PartyCup(f"{fruit}_cup", kind, (_pick(DRINKS, rng),) if full else ()))
    bowls = len(fruits) + 1 + FULL_AT_FIRST
    vessels += [PartyCup(f"bowl{k + 1}", "bowl") for k in range(bowls)]
    world = lay_out(machines, vessels, fruits, "office", rng, BANQUET)
    return Start(world, (*(f"JuiceInCup({f}, {f}_cup)" for f in fruits), "Empty(waste_cup)"))


FAMILIES: Mapping[str, StartMaker] = {
    "new-objects": _like_demonstrations(NEW_FRUITS, "office"),
    "new-background": _like_demonstrations(DEMONSTRATED_FRUITS, "studio"),
    "more-objects": _more_objects,
    "novel-goal-1": _no_waste_cup,
    "novel-goal-2": _full_juice_cup,
    "party": _party,
}
