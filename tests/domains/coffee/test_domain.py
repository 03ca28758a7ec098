from __future__ import annotations

import json
from collections.abc import Sequence

import pytest

from extras import need
from pix2pred.domains.coffee import CoffeeDomain
from pix2pred.domains.coffee.scenes import CUP_GAP, MOST_CUPS, initial_world
from pix2pred.domains.coffee.simulation.geometry import CUP_RADIUS
from pix2pred.domains.coffee.world import CoffeeWorld
from pix2pred.domains.seeds import Split, scene_generator
from pix2pred.structs import Demo, Pixels
from pix2pred.structs.environment import Domain, Filmed, SimulatedTask


@pytest.fixture(scope="module")
def demos(drawing: None) -> Sequence[Demo]:
    return CoffeeDomain().demonstrations("three-cups", 0)


@pytest.fixture(scope="module")
def task(drawing: None) -> SimulatedTask:
    return CoffeeDomain().tasks("three-cups", 3, 1)[0]


def test_it_is_a_domain() -> None:
    domain: Domain = CoffeeDomain()
    assert (domain.name, next(iter(domain.families))) == ("coffee", "three-cups")
    assert domain.settings("six-cups") == {
        "h_pre_frac": 0.8, "h_data_frac": 0.05, "j_threshold": 100, "early_stop": "level",
        "precondition_rule": "at_least", "max_plans": 1000,
    }  # fmt: skip
    hidden = {"is_on", "is_filled", "current", "target", "level"}
    assert not any(hidden & set(t.features) for t in domain.vocabulary("three-cups").types)
    with pytest.raises(ValueError, match="no family 'tea'"):
        domain.vocabulary("tea")


@need("mujoco", extra="sim")
def test_demonstrations(demos: Sequence[Demo]) -> None:
    assert [len(d.actions) for d in demos] == [6, 6, 5, 6, 5]
    assert len({d.name for d in demos}) == 5
    for demo in demos:
        reached = [set(demo.goal) <= state.given for state in demo.states]
        assert reached == [False] * len(demo.actions) + [True]
        for state in demo.states:
            (picture,) = state.pictures
            assert {"robot", "jug", "coffee_machine"} <= set(picture.boxes) <= {o.name for o in demo.objects}
            assert all(0 <= b.left < b.right <= 480 and 0 <= b.top < b.bottom <= 480 for b in picture.boxes.values())
            assert all(len(values) == len(o.type.features) for o, values in state.features.items())


@need("mujoco", extra="sim")
def test_hidden_state_is_in_the_pictures_alone(demos: Sequence[Demo]) -> None:
    before, after = demos[2].states[2:4]
    assert demos[2].actions[2].skill.name == "TurnMachineOnAndFill"
    moved = {o.name for o in demos[2].objects if before.features[o] != after.features[o]}
    assert moved == {"robot"}
    assert before.pictures[0].image != after.pictures[0].image


@need("mujoco", extra="sim")
def test_tasks_do_not_depend_on_each_other_and_survive_json(task: SimulatedTask) -> None:
    domain = CoffeeDomain()
    assert [o.name for o in task.task.objects] == ["coffee_machine", "cup0", "cup1", "cup2", "jug", "robot"]
    assert [str(a) for a in task.task.goal] == [f"CupFilled(cup{i})" for i in range(3)]
    environment = domain.environment(task.task, json.loads(json.dumps(task.simulator)))
    assert isinstance(environment, Filmed)
    assert environment.observe() == task.task.initial
    assert environment.features() == task.task.initial.features
    assert domain.tasks("three-cups", 3, 2)[0] == task


@need("mujoco", extra="sim")
def test_running_the_actions_from_the_starts_visits_the_demonstrations_again(demos: Sequence[Demo]) -> None:
    domain = CoffeeDomain()
    starts = domain.demonstration_starts("three-cups", 0)
    assert [s.task.name for s in starts] == [d.name for d in demos]
    for demo, start in zip(demos, starts, strict=True):
        assert start.task.initial == demo.states[0] and start.task.goal == demo.goal
        environment = domain.environment(start.task, start.simulator)
        for action, state in zip(demo.actions, demo.states[1:], strict=True):
            environment.execute(action)
            assert environment.features() == state.features


@need("mujoco", extra="sim")
def test_tasks_of_any_size(drawing: None, task: SimulatedTask) -> None:
    (sized,) = CoffeeDomain().sized_tasks("three-cups", 3, 1, 5)
    assert [o.name for o in sized.task.objects if o.type.name == "cup"] == [f"cup{i}" for i in range(5)]
    assert len(sized.task.goal) == 5
    three = CoffeeDomain().sized_tasks("three-cups", 3, 1, 3)[0]
    assert three.simulator != task.simulator, "scenes of their own"
    for none_or_too_many in (0, MOST_CUPS + 1):
        with pytest.raises(ValueError, match="cup"):
            CoffeeDomain().sized_tasks("three-cups", 3, 1, none_or_too_many)


@need("mujoco", extra="sim")
def test_film_shows_a_skill_while_it_runs(task: SimulatedTask) -> None:
    domain = CoffeeDomain()
    environment = domain.environment(task.task, task.simulator)
    frames: list[Pixels] = []
    environment.film(frames.append)
    objects = {o.name: o for o in task.task.objects}
    skill = {s.name: s for s in domain.vocabulary("three-cups").skills}["TurnMachineOnAndFill"]
    from pix2pred.structs import Action

    environment.execute(Action(skill, (objects["robot"], objects["coffee_machine"])))
    assert len(frames) >= 3 and frames[0].shape == (480, 480, 3)
    environment.film(None)


@pytest.mark.parametrize(
    "damage",
    [{}, {"family": "three-cups", "world": {}}, {"family": "three-cups", "world": {"cups": 1}}, {"family": 3},
     {"family": "tea", "world": None}],
)  # fmt: skip
@need("mujoco", extra="sim")
def test_damaged_simulator_states_are_refused(task: SimulatedTask, damage: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"coffee|family"):
        CoffeeDomain().environment(task.task, damage)


@pytest.mark.parametrize(
    ("path", "value"), [(("jug", "level"), 99.0), (("jug", "at"), [0.1, float("nan"), 0.2]), (("robot", "at"), [1.0])]
)
def test_impossible_worlds_are_refused(path: tuple[str, str], value: object) -> None:
    world = initial_world(2, scene_generator(0, Split.TASKS, 3, 0)).to_dict()
    assert CoffeeWorld.from_dict(world).to_dict() == world
    world[path[0]][path[1]] = value
    with pytest.raises(ValueError, match="not a coffee simulator state"):
        CoffeeWorld.from_dict(world)


def test_scenes() -> None:
    for cups in range(MOST_CUPS + 1):
        world = initial_world(cups, scene_generator(5, Split.TASKS, cups, 0))
        assert [c.name for c in world.cups] == [f"cup{i}" for i in range(cups)]
        for i, a in enumerate(world.cups):
            for b in world.cups[:i]:
                gap = ((a.x - b.x) ** 2 + (a.y - b.y) ** 2) ** 0.5 - CUP_RADIUS[a.capacity] - CUP_RADIUS[b.capacity]
                assert gap >= CUP_GAP
    away = [abs(initial_world(3, scene_generator(0, Split.TASKS, 3, i)).jug.rot) > 0.1 for i in range(40)]
    assert 10 < sum(away) < 30
    with pytest.raises(ValueError, match="9 cups"):
        initial_world(9, scene_generator(0, Split.TASKS, 3, 0))
