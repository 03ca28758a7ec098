"""Claims judged on made-up rows, and documents of which only the marked part changes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from extras import need
from pix2pred.benchmark import Row, Run, Suite, SuiteError, TryOutcome
from pix2pred.benchmark.claims import ClaimVerdict, judge, judge_interim, load_claims
from pix2pred.benchmark.report import END, begin, write_into, write_report
from pix2pred.benchmark.suite import load_suite, suite_names
from pix2pred.benchmark.tables import comparison, section

Counts = Mapping[tuple[str, str], int | TryOutcome]
PAPER = load_suite("paper")


def made_up(counts: Counts, learned: Mapping[str, dict[str, Any]] | None = None, folder: Path = Path("run")) -> Run:
    """A run of one seed in which the first ``n`` of ten tasks are solved, by (approach, family)."""
    rows = []
    for (approach, family), n in counts.items():
        if isinstance(n, TryOutcome):
            rows.append(Row(approach, family, None, 0, None, n))
            continue
        for i in range(10):
            solved = i < n
            outcome = TryOutcome.SOLVED if solved else TryOutcome.FAILED
            rows.append(Row(approach, family, None, 0, f"t{i}", outcome, cause="" if solved else "wrong label"))
    return Run(folder, PAPER.model_copy(update={"seeds": (0,)}), "offline", tuple(rows), dict(learned or {}))


def verdict(claim: str, run: Run) -> ClaimVerdict:
    return judge(next(c for c in load_claims().claims if c.id == claim), run).verdict


@pytest.mark.parametrize(
    ("claim", "counts", "expected"),
    [
        ("ours-above-no-invent", {("ours", "combo"): 5, ("no-invent", "combo"): 4}, ClaimVerdict.HOLDS),
        ("ours-above-no-invent", {("ours", "combo"): 5, ("no-invent", "combo"): 5}, ClaimVerdict.FAILS),
        ("ours-above-no-invent", {("ours", "combo"): 5}, ClaimVerdict.NOT_RUN),
        ("ours-above-no-visual", {("ours", "kitchen"): 1, ("no-visual", "kitchen"): 9}, ClaimVerdict.NOT_RUN),
        ("ours-above-vila-pure", {("ours", "combo"): 5, ("vila-pure", "combo"): TryOutcome.NEEDS_MODEL},
         ClaimVerdict.NEEDS_MODEL),
        ("no-subselect-fails", {("no-subselect", "combo"): 0}, ClaimVerdict.HOLDS),
        ("no-subselect-fails", {("no-subselect", "combo"): 1}, ClaimVerdict.FAILS),
        ("vila-fewshot-fails-when-holding", {("vila-fewshot", "combo"): 5}, ClaimVerdict.HOLDS),
        ("vila-fewshot-fails-when-holding", {("vila-fewshot", "combo"): 6}, ClaimVerdict.FAILS),
        ("vila-fewshot-comparable-in-kitchen", {("ours", "kitchen"): 9, ("vila-fewshot", "kitchen"): 10},
         ClaimVerdict.HOLDS),
        ("failures-are-wrong-labels", {("ours", "combo"): 8}, ClaimVerdict.HOLDS),
        ("failures-are-wrong-labels", {("ours", "combo"): 10}, ClaimVerdict.NOT_RUN),
    ],
)  # fmt: skip
def test_verdicts(claim: str, counts: Counts, expected: ClaimVerdict) -> None:
    assert verdict(claim, made_up(counts)) == expected


def test_one_family_refutes_a_claim_about_all() -> None:
    counts = {("ours", "combo"): 5, ("no-invent", "combo"): 0, ("ours", "bigger"): 5, ("no-invent", "bigger"): 5}
    assert verdict("ours-above-no-invent", made_up(counts)) == ClaimVerdict.FAILS


def test_sets_and_pools_are_judged_by_what_was_learned() -> None:
    learned = {"combo/seed0/ours": {"selected": ["a", "b", "c"], "visual": 3, "candidates": 120, "labels_from": "x"}}
    assert verdict("learned-sets", made_up({}, learned)) == ClaimVerdict.HOLDS
    assert verdict("pools-exceed-100", made_up({}, learned)) == ClaimVerdict.HOLDS
    learned["combo/seed0/ours"]["visual"] = 2
    assert verdict("learned-sets", made_up({}, learned)) == ClaimVerdict.FAILS


def test_interim_numbers_are_compared_range_to_range() -> None:
    found = judge_interim(load_claims().interim, made_up({("ours", "combo"): 9, ("no-feature", "combo"): 10}))
    by_cell = {(family, approach): verdict for family, approach, verdict, _ in found}
    assert by_cell["combo", "ours"] == ClaimVerdict.HOLDS
    assert by_cell["combo", "no-feature"] == ClaimVerdict.FAILS
    assert by_cell["kitchen", "ours"] == ClaimVerdict.NOT_RUN


def test_the_claims_file_is_the_one_under_tests_too() -> None:
    ours = Path(__file__).parents[1] / "paper" / "claims.yaml"
    assert "ours-above-no-invent" in ours.read_text(encoding="utf-8")
    assert ours.resolve().parent.name == "benchmark"


def test_a_report_names_date_command_reader_seeds_and_says_what_needs_a_model() -> None:
    learned = {"combo/seed0/ours": {"selected": ["a"], "visual": 1, "candidates": 9, "operators": 3,
                                    "labels_from": "offline:burger:123"}}  # fmt: skip
    run = made_up({("ours", "combo"): 10, ("vila-pure", "combo"): TryOutcome.NEEDS_MODEL}, learned)
    text = section(run, load_claims(), date="2026-01-02", command="pix2pred bench run paper", chart=None)
    assert "`pix2pred bench run paper` (2026-01-02)" in text and "offline:burger:123" in text and "Seeds 0," in text
    assert "| ours | not run | not run | not run | 10.0 ± 0.0 [72, 100] % | not run |" in text
    assert "needs a model" in text and "Not published results" in text


def test_only_the_marked_part_of_a_document_is_written(tmp_path: Path) -> None:
    document = tmp_path / "results.md"
    document.write_text(f"# Results\n\nby hand\n\n{begin('paper')}\nobsolete\n{END}\n\nalso by hand\n")
    run = made_up({("ours", "combo"): 10}, folder=tmp_path / "run")
    write_into(document, run, "2026-01-02")
    once = document.read_text()
    assert once.startswith("# Results\n\nby hand\n") and once.endswith(f"{END}\n\nalso by hand\n")
    assert "obsolete" not in once and "10.0 ± 0.0" in once
    write_into(document, run, "2026-01-02")
    assert document.read_text() == once


def test_a_short_mark_takes_what_was_solved_alone(tmp_path: Path) -> None:
    document = tmp_path / "README.md"
    document.write_text(f"{begin('paper', short=True)}\nobsolete\n{END}\n")
    write_into(document, made_up({("ours", "combo"): 10}, folder=tmp_path / "run"), "2026-01-02")
    text = document.read_text()
    assert "obsolete" not in text and "10.0 ± 0.0" in text and "Published claims" not in text


def test_a_document_without_the_marks_is_left_alone(tmp_path: Path) -> None:
    document = tmp_path / "results.md"
    document.write_text("by hand")
    with pytest.raises(SuiteError, match="put these lines in it"):
        write_into(document, made_up({}), "2026-01-02")
    assert document.read_text() == "by hand"


@need("matplotlib", extra="plot")
def test_the_chart_is_the_same_bytes_every_time(tmp_path: Path) -> None:
    run = made_up({("ours", "combo"): 9, ("no-invent", "combo"): 1, ("ours", "bigger"): 9}, folder=tmp_path)
    charts = []
    for _ in range(2):
        write_report(run, "2026-01-02")
        charts.append((tmp_path / "report" / "chart.png").read_bytes())
    assert charts[0] == charts[1] and charts[0].startswith(b"\x89PNG")


def test_runs_are_compared_over_the_tasks_that_both_tried() -> None:
    left, right = made_up({("ours", "combo"): 9, ("ours", "bigger"): 3}), made_up({("ours", "combo"): 4})
    table = comparison(left, right)
    assert "| ours | combo | 9 of 10 | 4 of 10 | 5 | 0 | 0.062 |" in table and "bigger" not in table


def test_every_bundled_suite_loads_and_the_paper_has_the_published_settings() -> None:
    from pix2pred.registry import load_approach, load_domain

    assert {"paper", "smoke", "items", "demonstrations", "pool", "label-noise"} <= set(suite_names())
    for name in suite_names():
        suite = load_suite(name)
        assert suite.name == name
        assert [load_approach(a).name for a in suite.approaches] == list(suite.approaches)
    assert (len(PAPER.approaches), PAPER.seeds, PAPER.tasks) == (9, (0, 1, 2, 3, 4), 10)
    published = {**load_domain("burger").settings("combo"), "operators": "cluster-and-intersect"}
    for entry in PAPER.families:
        if entry.domain == "burger":
            assert entry.settings["learning"].items() <= published.items()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"seeds": [1, 1]}, "seed 1 is listed twice"),
        ({"axis": {"of": "pool", "values": [0.5]}}, "whole numbers"),
        ({"axis": {"of": "label-noise", "values": [1]}}, "shares below 1"),
        ({"tasks": 0}, "greater than or equal to 1"),
        ({"families": [{"name": "a", "domain": "b", "settings": {"lerning": {}}}]}, "Extra inputs"),
    ],
)
def test_a_suite_that_makes_no_sense_is_refused(change: dict[str, object], message: str, tmp_path: Path) -> None:
    import yaml

    document = {"name": "x", "about": "x", "approaches": ["ours"], "families": [{"name": "a", "domain": "b"}],
                "seeds": [0], **change}  # fmt: skip
    path = tmp_path / "suite.yaml"
    path.write_text(yaml.safe_dump(document))
    with pytest.raises(SuiteError, match=message):
        load_suite(str(path))
    assert Suite.model_validate(
        {**document, "seeds": [0], "tasks": 1, "axis": None, "families": [{"name": "a", "domain": "b"}]}
    )


def test_the_robot_domains_are_compared_apart_and_as_printed() -> None:
    robot = [f for f in PAPER.families if f.domain in ("cleanup", "juice")]
    assert {(PAPER.approaches_of(f), PAPER.tasks_of(f)) for f in robot} == {(("ours", "vila-fewshot"), 3)}
    assert [[f.name for f in group] for group in PAPER.groups()][1] == [f.name for f in robot]
    run = made_up({("ours", "combo"): 5})
    solved = [
        Row(
            "ours", "juice-novel-goal-2", None, 0, f"t{i}", TryOutcome.SOLVED if i < 2 else TryOutcome.FAILED, cause="x"
        )
        for i in range(3)
    ]
    text = section(replace(run, rows=(*run.rows, *solved)), load_claims(), date="2026-01-02", command="c", chart=None)
    assert "Of 3 tasks per seed" in text and "| juice, ours | " in text and "2 of 3 [1/3] |" in text
    assert "juice-novel-goal-2: " not in text, "claims are about the simulated families"


def test_what_a_family_leaves_to_the_suite_is_not_written_down() -> None:
    written = PAPER.document()["families"]
    assert "tasks" not in written[0] and written[-1]["tasks"] == 3
    assert Suite.model_validate(PAPER.document()) == PAPER
    broken = PAPER.document() | {"approaches": ["no-invent"]}
    with pytest.raises(ValueError, match="no approach of the suite"):
        Suite.model_validate(broken)
