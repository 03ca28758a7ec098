"""Cleanup and Juice as the rest of the system sees them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from extras import need
from pix2pred.demos import read_project, write_project
from pix2pred.domains.cleanup import CleanupDomain
from pix2pred.domains.home.domain import HomeDomain
from pix2pred.domains.juice import JuiceDomain
from pix2pred.settings import Settings
from pix2pred.structs.environment import Asking, Domain, Filmed, asking_settings

DOMAINS = {"cleanup": CleanupDomain(), "juice": JuiceDomain()}
FIVE = ["new-objects", "new-background", "more-objects", "novel-goal-1", "novel-goal-2"]

pytestmark = pytest.mark.parametrize("name", list(DOMAINS))


def test_settings_and_vocabulary_are_the_published_ones(name: str) -> None:
    domain: Domain = DOMAINS[name]
    assert list(domain.families[:5]) == FIVE
    threshold = {"cleanup": 100, "juice": 0}[name]
    assert domain.settings(FIVE[0]) == {"h_pre_frac": 1.0, "h_data_frac": 0.4, "j_threshold": threshold}
    assert isinstance(domain, Asking)
    asking = asking_settings(domain, FIVE[0])
    settings = Settings.model_validate({"learning": domain.settings(FIVE[0]), **asking})
    assert (settings.proposal.max_atoms, settings.proposal.exclude) == (25, ("hand",))
    assert not settings.proposal.marks and not settings.labels.marks
    vocabulary = domain.vocabulary(FIVE[0])
    assert not any(t.features for t in vocabulary.types)
    sources = {p.name: type(p.source).__name__ for p in vocabulary.initial}
    told = {"Holding", "HoldingContainer", "HoldingObj", "HandEmpty"}
    assert {n for n, s in sources.items() if s == "FromDomain"} == told & set(sources)
    assert set(sources.values()) == {"FromDomain", "FromVLM"}
    with pytest.raises(ValueError, match="no family 'tea'"):
        domain.vocabulary("tea")


@need("mujoco", extra="sim")
@pytest.mark.usefixtures("drawing")
def test_tasks_survive_json_and_do_not_depend_on_each_other(name: str) -> None:
    domain: HomeDomain = DOMAINS[name]
    (_, task) = domain.tasks("new-objects", 3, 2)
    environment = domain.environment(task.task, json.loads(json.dumps(task.simulator)))
    assert isinstance(environment, Filmed) and environment.features() == {}
    assert environment.observe() == task.task.initial and not environment.goal_reached()
    assert len(task.task.initial.pictures) == 6
    assert domain.start("new-objects", 3, 1).world == environment.world
    with pytest.raises(ValueError, match="no disturbances"):
        domain.environment(task.task, task.simulator, disturb=0.5)


@need("mujoco", extra="sim")
@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize(
    "damage",
    [lambda s: {}, lambda s: {"world": {}}, lambda s: {"world": s["world"] | {"things": s["world"]["things"][1:]}}],
)
def test_damaged_simulator_states_are_refused(name: str, damage: Callable[..., dict[str, object]]) -> None:
    domain = DOMAINS[name]
    (task,) = domain.tasks("new-objects", 3, 1)
    with pytest.raises(ValueError, match=r"simulator state"):
        domain.environment(task.task, damage(task.simulator))


@need("mujoco", extra="sim")
@pytest.mark.usefixtures("drawing")
def test_a_project_folder_keeps_the_settings_of_asking(name: str, tmp_path: Path) -> None:
    domain = DOMAINS[name]
    demo = domain.demonstration(1, 2)
    asking = asking_settings(domain, "new-objects")
    write_project(tmp_path / "p", domain.vocabulary("new-objects"), [demo], asking=asking)
    project = read_project(tmp_path / "p")
    assert project.demos == (demo,)
    assert Settings.model_validate(project.sections).proposal.max_atoms == 25
