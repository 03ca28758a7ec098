"""docs/extending.md word for word: every example is installed as another package would be, and used by its name."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from cli.hostile_lamps import Fake, write_lamps
from lamps_run import learn_lamps
from pix2pred.approaches.approach import Training
from pix2pred.demos import read_project
from pix2pred.pipeline import LearningProblem
from pix2pred.planning.pddl.read import read_domain, read_problem
from pix2pred.registry import REGISTRY
from pix2pred.settings import of_project, resolve
from pix2pred.structs import PlanStatus
from pix2pred.structs.environment import KnowsTruth, Replayable, Sized
from pix2pred.structs.formats.names import UnknownNameError
from pix2pred.vlm import AnswerStore, Purpose, Request
from vlm.fault_server import FaultServer

PAGE = Path(__file__).parents[1] / "docs" / "extending.md"


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder on the import path with the page's files, declared as an installed package declares them."""
    text = PAGE.read_text(encoding="utf-8")
    root = tmp_path / "site"
    info = root / "extras-1.0.dist-info"
    info.mkdir(parents=True)
    files = re.findall(r"`(\w+)\.py`:\n\n```python\n(.*?)```", text, re.DOTALL)
    for name, code in files:
        (root / f"{name}.py").write_text(code)
    declared = re.findall(r'\[project\.entry-points\."([\w.]+)"\]\n(\w+) = "(.*?)"', text)
    assert {group for group, _, _ in declared} == {
        f"pix2pred.{group}" for group in ("approaches", "models", "providers", "heuristics", "searches")
    }
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: extras\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("".join(f"[{g}]\n{name} = {where}\n" for g, name, where in declared))
    monkeypatch.syspath_prepend(str(root))
    yield root
    for name, _ in files:
        sys.modules.pop(name, None)


def test_an_approach_from_outside_trains(installed: Path, tmp_path: Path) -> None:
    project = read_project(write_lamps(tmp_path / "data"))
    problem = LearningProblem(project.vocabulary, project.demos, Fake(), resolve(of_project(project.sections)))
    agent = REGISTRY.approach("unary").train(Training(problem, REGISTRY.planner("portfolio")))
    assert agent.plans_with is not None
    candidates = agent.plans_with.learned.labelling.table.pool
    assert [c.predicate.name for c in candidates] == ["lit0"]  # near, of two arguments, is left out


def test_a_kind_of_model_from_outside_answers_and_is_stored(installed: Path, tmp_path: Path) -> None:
    store = AnswerStore(tmp_path / "store")
    model = REGISTRY.stored("says:hello", None, store)
    request = Request(Purpose.PROPOSE, ("Hello?",), 10)
    assert model.answer(request).text == "hello"
    assert REGISTRY.stored("says:hello", None, store).answer(request).stored
    assert REGISTRY.estimator("says:hello", None, store).name == "says:hello"


def test_a_provider_from_outside_is_asked_and_reckoned_with(installed: Path) -> None:
    with FaultServer().running() as server:
        model = REGISTRY.vlm(f"elsewhere:tiny@{server.url}", None)
        answer = model.answer(Request(Purpose.LABEL, ("Is it?\n\nPredicates:\nlit(a)",), 100))
        assert model.name == "elsewhere:tiny" and answer.text.startswith("* lit(a)")
        assert '"max_tokens":2100' in server.bodies[0].replace(" ", ""), "thinking has room beside the answer"
    rates = REGISTRY.model_spec("elsewhere:tiny@http://localhost/v1").rates
    assert rates is not None and (rates.picture_tokens(512, 512), rates.thinking_tokens()) == (7, 2000)
    assert "elsewhere" in [p.name for p in REGISTRY.providers()]


def test_searches_and_heuristics_from_outside_plan(installed: Path, tmp_path: Path) -> None:
    run = learn_lamps(tmp_path, "run")
    domain = read_domain((run.path / "model/domain.pddl").read_text())
    text = (
        "(define (problem p) (:domain lamps) (:objects r - robot a b - lamp) (:init) (:goal (and (Done a) (Done b))))"
    )
    problem = read_problem(text, domain)
    for name in ("breadth", "gbfs-goals", "astar-goals"):
        found = REGISTRY.planner(name).plan(domain.operators, problem.objects, problem.initial, problem.goal)
        assert found.status == PlanStatus.SOLVED and len(found.plan) == 2
    with pytest.raises(UnknownNameError, match="breadth"):
        REGISTRY.planner("breath")


def test_what_a_domain_may_offer_is_found_in_its_methods() -> None:
    burger = REGISTRY.domain("burger")
    assert isinstance(burger, KnowsTruth) and isinstance(burger, Replayable) and isinstance(burger, Sized)
    task = burger.tasks("more-stacks", 0, 1)[0]
    environment = burger.environment(task.task, task.simulator)
    assert REGISTRY.truth(burger, environment) is not None
