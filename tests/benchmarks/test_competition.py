"""The competition benchmark: its traces are what they claim, and its scorer tells right models from wrong ones."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from random import Random

import numpy as np
import pytest

from pix2pred.learning import LearningSettings, hill_climbing, load_traces, selection_document
from pix2pred.structs import Label
from symbolic.problems import CATALOGUE, load_domain, to_problem
from symbolic.score import Verdict, execute, score_document, score_model
from symbolic.traces import CANDIDATES, make_traces

QUICK = ("ferry", "gripper", "miconic")


@pytest.mark.parametrize("name", CATALOGUE)
def test_domains_are_well_formed(name: str) -> None:
    generate, hides = CATALOGUE[name]
    for skill_args in ("all", "subset"):
        domain = load_domain(name, skill_args)
        skills = {op.skill for op in domain.operators}
        assert len({s.name for s in skills}) == len(skills), "one skill, one signature"
        assert {op.skill.name for op in domain.operators} == {s.name for s in skills}
    fluents = {a.predicate.name for op in domain.operators for a in (*op.add, *op.delete)}
    hidden = {p for hide in hides for p in hide}
    assert hidden <= fluents
    for large in (False, True):
        problem = to_problem(domain, "p", generate(Random(3), large))
        assert problem.goal
        assert not hidden & {a.predicate.name for a in problem.goal}
        for atom in (*problem.initial, *problem.goal):
            assert all(o.type.is_a(t) for o, t in zip(atom.objects, atom.predicate.types, strict=True)), atom


@pytest.mark.parametrize("name", QUICK)
@pytest.mark.parametrize("skill_args", ["all", "subset"])
def test_traces_are_read_back_and_reach_their_goals(tmp_path: Path, name: str, skill_args: str) -> None:
    workload = make_traces(name, 0, 0.05, 0.02, skill_args=skill_args)
    path = tmp_path / "traces.json"
    path.write_text(json.dumps(workload.document))
    read = load_traces(path)
    assert [d.abstract_states() for d in read.table.demos] == [d.abstract_states() for d in workload.table.demos]
    assert len(read.table.demos) == 12
    assert len(read.table.pool) == CANDIDATES
    assert set(workload.hidden) <= {c.predicate.name for c in read.table.pool}
    for demo in read.table.demos:
        assert demo.abstract_states()[-1] >= set(demo.goal)
        assert 3 <= len(demo.actions) <= 15


def test_only_candidates_are_mislabelled_and_at_the_rate_asked() -> None:
    exact, noisy = make_traces("ferry", 0, 0.0), make_traces("ferry", 0, 0.05, 0.1)
    flips = unknown = labels = 0
    for true, seen in zip(exact.table.demos, noisy.table.demos, strict=True):
        assert true.atoms == seen.atoms
        given = np.array([a.predicate in exact.table.initial for a in true.atoms])
        assert (true.values[:, given] == seen.values[:, given]).all()
        a, b = true.values[:, ~given], seen.values[:, ~given]
        unknown += int((b == Label.UNKNOWN).sum())
        flips += int(((a != b) & (b != Label.UNKNOWN)).sum())
        labels += a.size
    assert abs(unknown / labels - 0.1) < 0.01
    assert abs(flips / (labels - unknown) - 0.05) < 0.01


def test_sticky_errors_change_only_when_touched() -> None:
    exact, noisy = make_traces("ferry", 0, 0.0), make_traces("ferry", 0, 0.1, sticky=True)
    changes = 0
    for true, seen in zip(exact.table.demos, noisy.table.demos, strict=True):
        wrong = true.values != seen.values
        for t, action in enumerate(true.actions):
            for i in np.flatnonzero(wrong[t] != wrong[t + 1]):
                objects = true.atoms[i].objects
                assert not objects or set(objects) & set(action.objects)
                changes += 1
    assert changes


def test_the_hash_seed_changes_nothing() -> None:
    root = Path(__file__).parents[2]
    code = "import json; from symbolic.traces import make_traces; w = make_traces('ferry', 1, 0.02); " \
           "print(json.dumps(w.document), w.hidden, sorted(map(str, w.tests[0].initial)))"  # fmt: skip
    path = f"{root / 'benchmarks'}{os.pathsep}{root / 'src'}"
    texts = {
        subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONPATH": path},
            capture_output=True, text=True, check=True,
        ).stdout
        for hash_seed in ("0", "1")
    }  # fmt: skip
    assert len(texts) == 1
    assert make_traces("ferry", 2, 0.02).document != make_traces("ferry", 1, 0.02).document


@pytest.mark.parametrize("name", QUICK)
@pytest.mark.parametrize("skill_args", ["all", "subset"])
def test_the_true_model_solves_everything_and_wrong_ones_do_not(name: str, skill_args: str) -> None:
    workload = make_traces(name, 0, 0.0, skill_args=skill_args)
    operators = workload.true_operators()
    assert score_model(workload, workload.hidden, operators).solved == 10
    blind = score_model(workload, (), workload.true_operators(known=False))
    assert blind.solved < 10, "what is hidden is needed"
    careless = [replace(op, preconditions=frozenset()) for op in operators]
    assert score_model(workload, workload.hidden, careless).verdicts == (Verdict.REFUSED,) * 10
    idle = score_model(workload, workload.hidden, [replace(op, delete=op.add, add=frozenset()) for op in operators])
    assert idle.verdicts == (Verdict.NO_PLAN,) * 10


def test_plans_are_judged_by_the_true_domain() -> None:
    workload = make_traces("ferry", 0, 0.0)
    problem = workload.tests[0]
    car = next(o for o in problem.objects if o.type.name == "car")
    port = next(o for o in problem.objects if o.type.name == "port")
    assert execute(workload.domain, problem, []) == Verdict.MISSED
    assert execute(workload.domain, problem, [("debark", (car, port))]) == Verdict.REFUSED


def test_a_selection_and_its_file_score_the_same() -> None:
    workload = make_traces("miconic", 0, 0.0)
    settings = LearningSettings(operators="cluster-and-intersect")
    selection = hill_climbing(workload.table, settings).run()
    direct = score_model(workload, [p.name for p in selection.selected], selection.operators)
    document = json.loads(json.dumps(selection_document(selection, settings)))
    assert score_document(workload, document) == direct
    assert direct.solved == 10


def test_every_candidate_has_a_true_value_at_the_start_of_every_test() -> None:
    workload = make_traces("miconic", 0, 0.0)
    everything = [c.predicate.name for c in workload.columns]
    for problem in workload.tests:
        state = workload.initial_state(problem, everything)
        assert {a for a in state if a.predicate in workload.table.initial} <= problem.initial
        for atom in state:
            assert set(atom.objects) <= set(problem.objects)
    first = workload.table.demos[0]
    assert (first.values != Label.UNKNOWN).all() and (first.values == Label.TRUE).any()
