"""Odd worlds from end to end, with the offline reader: an outcome with its cause, never an exception."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import home_truth
from extras import need
from pix2pred.domains.cleanup import CleanupDomain
from pix2pred.domains.cleanup import scenes as cleanup
from pix2pred.domains.cleanup import truth as cleanup_truth
from pix2pred.domains.home.domain import HomeDomain, Start
from pix2pred.domains.home.world import Body, World
from pix2pred.domains.juice import JuiceDomain
from pix2pred.domains.juice import scenes as juice
from pix2pred.domains.juice import truth as juice_truth
from pix2pred.execution import Solver
from pix2pred.learning import LearningSettings, learn_operators
from pix2pred.predicates import Labeller, LabelSettings
from pix2pred.registry import REGISTRY, load_planner
from pix2pred.structs import Episode, Failure, WorldModel
from pix2pred.vlm.offline.model import load_words

pytestmark = [need("mujoco", extra="sim"), pytest.mark.usefixtures("drawing")]

DOMAINS: Mapping[str, HomeDomain] = {"cleanup": CleanupDomain(), "juice": JuiceDomain()}
TRUTH: Mapping[str, home_truth.ValueOf] = {"cleanup": cleanup_truth.concept_value, "juice": juice_truth.concept_value}
WORDS = {
    "cleanup": ("IsOnFloor", "IsEraser", "NoObjectsOnTop", "IsOn"),
    "juice": ("IsCup", "NearJuiceValve", "InsideWasteValveRegion", "OutsideJuiceMachine", "LidClosed",
              "JuiceMachineOpen", "IsPlastic", "HasContents"),
}  # fmt: skip


@cache
def model(name: str) -> WorldModel:
    """The operators of perfect labels, over the words that the reader reads."""
    domain = DOMAINS[name]
    words = {w.word: (w, types) for w, types in load_words(domain.reader or Path()).uses()}
    predicates = home_truth.visual(domain, {n: words[n][1] for n in WORDS[name]})
    concepts = {predicates[n]: n for n in WORDS[name]}

    def value(world: World, word: str, names: Sequence[str]) -> bool:
        use = words[word][0]
        return TRUTH[name](world, str(use.concept), names) != use.negated

    table = home_truth.true_table(domain, concepts, value)
    settings = LearningSettings.model_validate(domain.settings("new-objects"))
    vocabulary = domain.vocabulary("new-objects")
    return WorldModel(vocabulary, tuple(predicates.values()), tuple(learn_operators(table, settings)), "truth")


def tried(name: str, world: World, *goal: str, closed_loop: bool = False) -> Episode:
    """The task of reaching ``goal`` in ``world``, with labels read from pictures."""
    domain = DOMAINS[name]
    stored = domain.task("odd", Start(world, goal))
    environment = domain.environment(stored.task, stored.simulator)
    labeller = Labeller(REGISTRY.vlm("offline", name), LabelSettings(marks=False))
    solver = Solver(model(name), load_planner("portfolio"), labeller, closed_loop)
    return solver.solve(stored.task, environment, REGISTRY.truth(domain, environment))


def tidy(things: Mapping[str, str], seed: int = 0, **more: object) -> World:
    plan = cleanup.CleanupScene(things, **more)  # type: ignore[arg-type]
    return cleanup.make_world(plan, Body.ROBOT, "office", np.random.default_rng(seed))


def test_a_table_that_nothing_can_wipe_has_no_plan() -> None:
    episode = tried("cleanup", tidy({}), "WipedOfMarkerScribbles(desk)")
    assert episode.failure == Failure.NO_PLAN and "cannot be reached" in episode.detail
    looking = tried("cleanup", tidy({}), "WipedOfMarkerScribbles(desk)", closed_loop=True)
    assert not looking.solved and looking.detail and not looking.steps


def test_an_empty_table_is_wiped() -> None:
    episode = tried("cleanup", tidy({"eraser": "floor"}), "WipedOfMarkerScribbles(desk)")
    assert episode.solved and len(episode.plan) == 2


def test_of_two_erasers_one_is_taken_out_of_the_way_of_the_other() -> None:
    world = tidy({"eraser": "floor", "eraser2": "desk"}, kinds={"eraser2": "eraser"})
    episode = tried("cleanup", world, "WipedOfMarkerScribbles(desk)")
    assert episode.solved, episode.detail


def test_a_bin_that_no_camera_shows_is_unknown_and_out_of_reach() -> None:
    world = tidy({"ball": "floor"})
    hidden = world.with_thing(replace(world.thing("wide_bin"), at=(9.0, 9.0, 0.0)))
    start = DOMAINS["cleanup"].task("odd", Start(hidden, ("InsideContainer(ball, wide_bin)",))).task
    assert not any("wide_bin" in picture.boxes for picture in start.initial.pictures)
    episode = tried("cleanup", hidden, "InsideContainer(ball, wide_bin)")
    assert not episode.solved and "wide_bin is out of reach" in episode.detail


def test_a_fruit_that_is_too_large_does_not_go_in() -> None:
    cups = {"cup": juice.Cup("plastic_cup", "juice"), "waste": juice.Cup("tumbler", "waste")}
    world = juice.make_world(juice.Plan(cups, ("melon",)), Body.ROBOT, "office", np.random.default_rng(1))
    episode = tried("juice", world, "JuiceInCup(melon, cup)")
    assert not episode.solved and "melon is too large for juicer" in episode.detail
