from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence

import pytest

from pix2pred.domains.burger import BurgerDomain
from pix2pred.domains.burger import environment as environment_module
from pix2pred.domains.burger.environment import HORIZON, BurgerEnvironment
from pix2pred.domains.burger.families import Variant, bind_action, bind_atom, load_families
from pix2pred.domains.burger.scenes import initial_world
from pix2pred.domains.burger.vocabulary import CHOP, COOK, PATTY, PICK, PLACE, make_object
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.structs import Application, Demo, State
from pix2pred.structs.environment import Domain, SimulatedTask, StepStatus

LENGTHS = {"more-stacks": [14] + [7] * 11, "bigger": [7, 10, 10] * 4, "combo": [7, 7, 9, 5] * 3}


def test_it_is_a_domain() -> None:
    domain: Domain = BurgerDomain()
    assert (domain.name, tuple(domain.families)) == ("burger", ("more-stacks", "bigger", "combo", "banquet"))
    assert domain.settings("combo") == {
        "h_pre_frac": 0.8, "h_data_frac": 0.05, "j_threshold": 2000, "early_stop": "level",
        "precondition_rule": "at_least", "max_plans": 200,
    }  # fmt: skip


@pytest.mark.parametrize("family", LENGTHS)
def test_demonstrations(demos: Mapping[str, Sequence[Demo]], family: str) -> None:
    found = demos[family]
    assert [len(d.actions) for d in found] == LENGTHS[family]
    assert sum(len(d.actions) for d in found) == {"more-stacks": 91, "bigger": 108, "combo": 84}[family]
    assert len({d.name for d in found}) == 12
    for demo in found:
        reached = [set(demo.goal) <= state.given for state in demo.states]
        assert reached == [False] * len(demo.actions) + [True]
        for state in demo.states:
            (picture,) = state.pictures
            assert set(picture.boxes) == {o.name for o in demo.objects} == {o.name for o in state.features}
            assert all(0 <= b.left < b.right <= 640 and 0 <= b.top < b.bottom <= 640 for b in picture.boxes.values())
            assert all(len(values) == len(o.type.features) for o, values in state.features.items())


def test_scripts_in_the_order_of_the_golden_checks(demos: Mapping[str, Sequence[Demo]]) -> None:
    last = [str(a) for a in demos["combo"][3].actions]
    assert last == [
        "Pick(robot, lettuce1)", "Place(robot, lettuce1, cutting_board)", "Chop(robot, lettuce1, cutting_board)",
        "Pick(robot, lettuce1)", "Place(robot, lettuce1, patty1)",
    ]  # fmt: skip
    assert "On(patty1, grill)" in {str(a) for a in demos["combo"][3].states[0].given}
    assert {o.type.name for o in demos["more-stacks"][0].objects} == {
        "robot",
        "grill",
        "patty",
        "top_bun",
        "bottom_bun",
    }


def test_hidden_state_is_not_in_features(demos: Mapping[str, Sequence[Demo]]) -> None:
    demo = demos["combo"][0]
    raw, cooked = demo.states[2], demo.states[3]
    assert str(demo.actions[2]) == "Cook(robot, patty1, grill)"
    robot = next(o for o in demo.objects if o.name == "robot")
    moved = {o for o in demo.objects if raw.features[o] != cooked.features[o]}
    assert moved <= {robot}
    assert raw.given == cooked.given
    assert raw.pictures[0].image != cooked.pictures[0].image


@pytest.mark.parametrize(
    ("family", "variant", "free", "holding"),
    [("more-stacks", "paper", 12, 14), ("bigger", "paper", 9, 10), ("combo", "paper", 12, 14),
     ("bigger", "reference", 9, 10), ("combo", "reference", 8, 9)],
)  # fmt: skip
def test_shapes_of_test_tasks(family: str, variant: Variant, free: int, holding: int) -> None:
    tasks = BurgerDomain(variant).tasks(family, 3, 2)
    assert [t.task.name for t in tasks] == [f"{family}-test-{i}" for i in range(2)]
    assert [len(t.task.objects) for t in tasks] == [free, holding]
    assert [fingers(t) for t in tasks] == [0.0, 1.0]
    for simulated in tasks:
        world = BurgerDomain().environment(simulated.task, simulated.simulator).world
        grounded = [t.cell for t in world.things if t.name != world.held]
        assert len(set(grounded)) == len(grounded) <= 12
        assert not any(t.prepared for t in world.things)
        assert not any(o.startswith("cheese") for o in world.types() if world.held)
        if world.held:
            assert (world.thing(world.held).type, world.thing(world.held).z) == ("patty", 1)
            assert f"OnGround({world.held})" not in {str(a) for a in simulated.task.initial.given}


def fingers(simulated: SimulatedTask) -> float:
    robot = next(o for o in simulated.task.objects if o.name == "robot")
    return simulated.task.initial.features[robot][3]


def test_half_of_ten_tasks_are_holding_and_a_task_does_not_depend_on_the_others() -> None:
    domain = BurgerDomain()
    tasks = domain.tasks("bigger", 0, 10)
    assert [fingers(t) for t in tasks] == [0.0] * 5 + [1.0] * 5
    assert domain.tasks("bigger", 0, 2)[0] == tasks[0]
    assert domain.tasks("bigger", 1, 1)[0].simulator != tasks[0].simulator


def test_held_level_flag() -> None:
    (_, holding) = BurgerDomain(held_z=0).tasks("bigger", 0, 2)
    assert "OnGround(patty3)" in {str(a) for a in holding.task.initial.given}


def test_an_environment_starts_where_its_task_does_and_survives_json() -> None:
    domain = BurgerDomain()
    (simulated,) = domain.tasks("bigger", 5, 1)
    environment = domain.environment(simulated.task, json.loads(json.dumps(dict(simulated.simulator))))
    assert environment.observe() == simulated.task.initial
    assert not environment.goal_reached()


def test_wrong_names_and_states_are_refused() -> None:
    domain = BurgerDomain()
    (task,) = domain.tasks("bigger", 0, 1)
    (other,) = domain.tasks("combo", 0, 1)
    with pytest.raises(ValueError, match="choose from"):
        domain.vocabulary("pizza")
    with pytest.raises(ValueError, match="variant"):
        BurgerDomain("best")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="not a burger simulator state"):
        domain.environment(task.task, {})
    with pytest.raises(ValueError, match="not those of"):
        domain.environment(task.task, other.simulator)


def build(bun: str, patty: str, lettuce: str = "", top: str = "", *, held: bool = False) -> list[tuple[str, ...]]:
    """A burger with a cooked patty and maybe chopped lettuce."""
    plan = [
        ("Pick", patty),
        ("Place", patty, "grill"),
        ("Cook", patty, "grill"),
        ("Pick", patty),
        ("Place", patty, bun),
    ]
    if held:
        plan = plan[1:]
    if lettuce:
        board = "cutting_board"
        plan += [("Pick", lettuce), ("Place", lettuce, board), ("Chop", lettuce, board), ("Pick", lettuce)]
        plan += [("Place", lettuce, patty)]
    return plan + ([("Pick", top), ("Place", top, lettuce or patty)] if top else [])


PLANS = {
    "more-stacks": build("bottom_bun6", "patty6", held=True)
    + [skill for i in range(1, 6) for skill in build(f"bottom_bun{i}", f"patty{i}")],
    "bigger": build("bottom_bun2", "patty3", held=True)
    + build("bottom_bun1", "patty1")
    + build("patty1", "patty2", top="top_bun1"),
    "combo": build("bottom_bun3", "patty3", top="top_bun3", held=True)
    + [skill for i in "12" for skill in build(f"bottom_bun{i}", f"patty{i}", f"lettuce{i}", f"top_bun{i}")],
}


@pytest.mark.parametrize(("family", "length"), [("more-stacks", 29), ("bigger", 16), ("combo", 30)])
def test_intended_plans_reach_the_goal_within_the_horizon(
    family: str, length: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(environment_module, "observe", lambda world, predicates: State())
    chosen = load_families()[family]
    recipe = chosen.test_recipes("paper").holding
    assert len(PLANS[family]) == length
    for index in range(40):
        world = initial_world(recipe.scene, scene_generator(index, Split.TASKS, chosen.index, 5))
        objects = {n: make_object(n, t) for n, t in world.types().items()}
        goal = [bind_atom(a, objects, chosen.initial) for a in recipe.goal]
        episode = BurgerEnvironment(world, (), goal)
        for skill in PLANS[family]:
            action = bind_action(Application(skill[0], ("robot", *skill[1:])), objects)
            assert not episode.goal_reached()
            assert episode.execute(action).status is StepStatus.DONE
        assert episode.goal_reached()
        assert episode.steps < HORIZON


def digest(family: str, seed: int) -> str:
    (task,) = BurgerDomain().tasks(family, seed, 1)
    state = task.task.initial
    text = json.dumps(dict(task.simulator)) + state.pictures[0].image.digest + " ".join(map(str, sorted(state.given)))
    return hashlib.sha256(text.encode()).hexdigest()


def test_same_bytes_whatever_the_hash_seed() -> None:
    code = (
        "from pix2pred.domains.burger import BurgerDomain as B\n"
        "import json, hashlib\n"
        "t = B().tasks('combo', 4, 1)[0]\n"
        "s = t.task.initial\n"
        "x = json.dumps(dict(t.simulator)) + s.pictures[0].image.digest + ' '.join(map(str, sorted(s.given)))\n"
        "print(hashlib.sha256(x.encode()).hexdigest(), list(s.features)[0].name, *map(str, t.task.goal))\n"
    )
    runs = {
        subprocess.run(
            [sys.executable, "-c", code], env=os.environ | {"PYTHONHASHSEED": seed},
            capture_output=True, text=True, check=True,
        ).stdout
        for seed in ("1", "2")
    }  # fmt: skip
    assert len(runs) == 1
    assert runs.pop().split()[0] == digest("combo", 4)


def test_skills_have_the_published_arguments() -> None:
    assert [str(s) for s in (PICK, PLACE, COOK, CHOP)] == [
        "Pick(robot, item)", "Place(robot, item, object)", "Cook(robot, patty, grill)",
        "Chop(robot, lettuce, cutting_board)",
    ]  # fmt: skip
    assert PATTY.features == ("row", "col", "z")
