"""The example of docs/your_own_domain.md, word for word, found through an entry point as another package's would be."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from extras import need
from pix2pred.execution import Solver
from pix2pred.learning import LearningSettings
from pix2pred.pipeline import LearningProblem, learn
from pix2pred.planning import AStar, Planner
from pix2pred.predicates import Labeller, LabelSettings
from pix2pred.registry import load_domain
from pix2pred.settings import Settings
from pix2pred.structs import Failure
from pix2pred.structs.views import View
from pix2pred.vlm.noise.oracle import NoisyOracle
from pix2pred.vlm.offline.prompt_format import KnownWord

PAGE = Path(__file__).parents[1] / "docs" / "your_own_domain.md"


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder on the import path with the example as an installed package."""
    text = PAGE.read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    (declared,) = re.findall(r'```toml\n\[project.entry-points."pix2pred.domains"\]\n(\w+) = "(.*?)"\n```', text)
    (tmp_path / "studio_domain.py").write_text(code)
    info = tmp_path / "studio-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: studio\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[pix2pred.domains]\n{} = {}\n".format(*declared))
    monkeypatch.syspath_prepend(str(tmp_path))
    yield tmp_path
    sys.modules.pop("studio_domain", None)


def is_lit(view: View, word: str, names: Sequence[str]) -> bool:
    """What anybody sees: the upper part of the lamp is yellow."""
    box = view.picture.boxes[names[0]]
    return bool(view.picture.image.pixels()[int(box.top) + 5, int(box.left) + 5, 0] > 200)


def test_the_example_learns_and_solves(package: Path) -> None:
    domain = load_domain("studio")
    vocabulary = domain.vocabulary("photographs")
    oracle = NoisyOracle([KnownWord("lit", ("lamp",), "lit", False)], is_lit)
    settings = Settings(learning=LearningSettings.model_validate(domain.settings("photographs")))
    learned = learn(LearningProblem(vocabulary, domain.demonstrations("photographs", 0), oracle, settings))
    assert [p.name for p in learned.selection.selected] == ["lit0"]
    assert len(learned.samplers) == 1
    solver = Solver(learned.model, Planner(AStar()), Labeller(oracle, LabelSettings()), samplers=learned.samplers)
    for stored in domain.tasks("photographs", 1, 3):
        episode = solver.solve(stored.task, domain.environment(stored.task, stored.simulator))
        assert episode.solved, (episode.detail, episode.steps)
        assert {s.sampler for s in episode.steps if s.action.startswith("Press")} == {"gaussian"}
    unlearned = replace(solver, samplers={})
    tried = [
        unlearned.solve(stored.task, domain.environment(stored.task, stored.simulator))
        for stored in domain.tasks("photographs", 2, 6)
    ]
    failed = [episode for episode in tried if not episode.solved]
    assert failed and {episode.failure for episode in failed} == {Failure.SKILL}
    assert "not pressed hard enough" in failed[0].detail and "'uniform'" in failed[0].detail


def test_the_command_line_writes_and_checks_its_project(package: Path) -> None:
    out = package / "data"
    for arguments in (["generate", "studio", "--tasks", "2", "--out", str(out)], ["check", str(out)]):
        command = [sys.executable, "-c", "from pix2pred.cli import main; main()", *arguments]
        result = subprocess.run(
            command, capture_output=True, text=True, cwd=package, check=False, env=_on_path(package)
        )
        assert result.returncode == 0, result.stderr


@need("gymnasium", extra="gym")
def test_it_is_a_gymnasium_environment(package: Path) -> None:
    import gymnasium
    from gymnasium.envs.registration import registry

    from pix2pred.gym_envs import DomainEnv, register_all

    for name in [n for n in registry if n.startswith("pix2pred/")]:
        del registry[name]
    with gymnasium.envs.registration.namespace("pix2pred"):
        register_all()
    made = gymnasium.make("pix2pred/Studio-v0")
    env = made.unwrapped
    assert isinstance(env, DomainEnv)
    made.reset(seed=0)
    rewards = []
    for lamp in ("lamp0", "lamp1", "lamp2"):
        made.step(env.action("Press", ("robot", lamp), (0.9,)))
        rewards.append(made.step(env.action("Photograph", ("robot", lamp)))[1])
    assert rewards == [0.0, 0.0, 1.0]


def _on_path(folder: Path) -> dict[str, str]:
    return os.environ | {"PYTHONPATH": str(folder)}
