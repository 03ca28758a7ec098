"""The package as a script sees it: names loaded when first used, and the ten lines of the README."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

import pix2pred as p2p
from cli.hostile_lamps import Fake, write_lamps
from extras import need
from lamps_run import learn_lamps
from pix2pred.runs.folder import RunFolderError
from pix2pred.vlm import VLMError


def test_importing_loads_nothing_and_takes_no_time() -> None:
    code = "import sys; before = set(sys.modules); import pix2pred; print(*sorted(set(sys.modules) - before))"
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert [m for m in printed if m.startswith("pix2pred")] == ["pix2pred"]
    assert not {"numpy", "pydantic", "PIL", "sklearn", "rich", "yaml", "jinja2"} & set(printed)


def test_every_name_is_there_and_no_other() -> None:
    for name in p2p.__all__:
        assert getattr(p2p, name) is not None
    assert dir(p2p) == p2p.__all__
    with pytest.raises(AttributeError, match="no attribute 'lern'"):
        p2p.lern  # type: ignore[attr-defined]  # noqa: B018


def test_ten_lines_from_data_to_a_plan(tmp_path: Path) -> None:
    folder = write_lamps(tmp_path / "lamps")
    seeing = Fake()
    data = p2p.read_data(folder)
    model = p2p.learn(data, vlm=seeing)
    assert len(model.operators) == 1 and "(:action press-lamp" in model.pddl
    assert [p.name for p in model.selected] == [p.name for p in model.world.selected]
    asked = len(seeing.asked)
    found = model.plan(folder / "tasks/t0")
    assert found.solved and found.actions == ("Press(robby, l1)", "Press(robby, l2)")
    assert model.plan(str(folder / "tasks/t0")).actions == found.actions
    assert model.plan(p2p.Task("same", found.task.objects, found.task.initial, found.task.goal)).solved
    assert "What the plan rests on" in p2p.Model.explain(found)
    assert asked > 0 and model.learned is not None


def test_a_run_folder_gives_a_model_and_its_answers_a_replay(tmp_path: Path) -> None:
    run = learn_lamps(tmp_path, "run").path
    config = run / "config.yaml"
    config.write_text(re.sub(r"^vlm: fake$", f"vlm: replay:{run}", config.read_text(), flags=re.MULTILINE))
    model = p2p.load_model(run)
    assert model.learned is None and len(model.operators) == 1
    again = p2p.learn(tmp_path / "data", vlm=f"replay:{run}")
    assert again.operators == model.operators
    other = p2p.load_model(run, vlm=f"mailbox:{tmp_path / 'inbox'}")
    assert other.operators == model.operators and other.solver.labeller.vlm.name == "mailbox"
    config.write_text(re.sub(r"^model: .*$", "model: another", config.read_text(), flags=re.MULTILINE))
    with pytest.raises(RunFolderError, match="was labelled by another"):
        p2p.load_model(run)
    with pytest.raises(RunFolderError, match="holds no run"):
        p2p.load_model(tmp_path / "nowhere")
    with pytest.raises(VLMError, match="no answers to replay"):
        p2p.learn(tmp_path / "data", vlm=f"replay:{tmp_path / 'nowhere'}")


@need("unified_planning", extra="planners")
def test_a_model_and_a_scene_become_a_problem_of_unified_planning(tmp_path: Path) -> None:
    folder = write_lamps(tmp_path / "lamps")
    model = p2p.learn(folder, vlm=Fake())
    domain = model.to_unified_planning()
    assert [a.name for a in domain.actions] == ["press-lamp"] and not domain.goals
    problem = model.to_unified_planning(model.plan(folder / "tasks/t0"))
    assert {o.name for o in problem.all_objects} == {"robby", "l1", "l2"} and problem.goals
