"""Arguments that make no sense are refused before any work."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from cli.hostile import NothingDrawn, refused, said, tree
from command_line import Cli
from pix2pred.registry import Registry
from pix2pred.vlm import StoredVLM


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--disturb", "2"], "--disturb"),
        (["--disturb", "nan"], "--disturb"),
        (["--disturb", "-0.1"], "--disturb"),
        (["--planner", "gbfs"], "did you mean 'gbfs-ff'"),
        (["--family", "biger"], "did you mean 'bigger'"),
        (["--domain", "burgre"], "did you mean 'burger'"),
        (["--count", "x"], "--count"),
        (["--count", "-3"], "--count"),
        (["--count", "0"], "--count"),
        (["--seed", "-1"], "--seed"),
    ],
)
def test_bad_options_of_solve(cli: Cli, run_copy: Path, options: list[str], message: str) -> None:
    before = tree(run_copy)
    refused(cli("solve", run_copy, *options), message)
    assert tree(run_copy) == before


@pytest.mark.parametrize(("options", "message"), [(["--tasks", "-1"], "--tasks"), (["--seed", "-1"], "--seed")])
def test_bad_options_of_generate(cli: Cli, tmp_path: Path, options: list[str], message: str) -> None:
    cli.registry = NothingDrawn()
    refused(cli("generate", "burger", *options, "--out", tmp_path / "data"), message)
    assert not (tmp_path / "data").exists()


class NeverAsked(Registry):
    """A registry without a model."""

    def stored(self, *_: object, **__: object) -> StoredVLM:
        raise AssertionError("learns before looking at the options")


@pytest.mark.parametrize("options", [["--count", "0"], ["--seed", "-1"]])
def test_bad_options_of_demo(cli: Cli, tmp_path: Path, options: list[str]) -> None:
    cli.registry = NeverAsked()
    refused(cli("demo", *options, "--out", tmp_path / "demo"), options[0])


def test_asking_demo_for_more_tasks_than_before_says_why_not_before_learning(
    cli: Cli, project: Path, tmp_path: Path
) -> None:
    cli.registry = NeverAsked()
    shutil.copytree(project, tmp_path / "burger-more-stacks-seed70" / "data")
    refused(cli("demo", "--seed", 70, "--count", 3, "--out", tmp_path), "holds 2 tasks", "--out")


def test_tasks_of_another_family_end_cleanly(cli: Cli, run_copy: Path) -> None:
    ran = cli("solve", run_copy, "--family", "combo", "--count", 1, "--json")
    assert ran.code in (1, 2) and "Traceback" not in ran.err
    if ran.code == 1:
        assert sum(ran.json["failures"].values()) == 1


def test_tasks_of_another_domain_are_refused(cli: Cli, run_copy: Path, data: Path) -> None:
    refused(cli("solve", run_copy, "--tasks", data, "--plan-only"), "task.yaml:", "lamp")


def test_tasks_of_no_simulator_say_how_to_plan_anyway(cli: Cli, data: Path, done: Path) -> None:
    (data / "tasks/t0/simulator.json").write_text('{"a": 1}')
    ran = cli("solve", done, "--tasks", data)
    refused(ran)
    assert "--plan-only" in said(ran) or "--domain" in said(ran)


SIMULATORS = [
    '{"a": 1}',
    '{"family": [], "world": {}}',
    '{"family": "more-stacks", "world": 3}',
    '{"family": "x", "world": {}}',
]


@pytest.mark.parametrize("text", SIMULATORS)
def test_simulator_states_that_fit_no_task_are_named(
    cli: Cli, project: Path, run_copy: Path, tmp_path: Path, text: str
) -> None:
    shutil.copytree(project, tmp_path / "data")
    file = sorted(tmp_path.glob("data/tasks/*/simulator.json"))[0]
    file.write_text(text)
    refused(cli("solve", run_copy, "--tasks", tmp_path / "data"), file.parent.name, "simulator.json")
