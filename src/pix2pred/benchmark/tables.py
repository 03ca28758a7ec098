"""Runs as Markdown and CSV: figures, causes of failures, claims. A function of rows alone."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter

from pix2pred.benchmark.claims import Judged, Printed, Published, judge, judge_interim
from pix2pred.benchmark.rows import TryOutcome
from pix2pred.benchmark.runner import Run, expected
from pix2pred.benchmark.statistics import TableCell, cell_of, sign_test
from pix2pred.benchmark.suite import FamilyEntry


def markdown(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "".join("| " + " | ".join(c.replace("|", "\\|") for c in line) + " |\n" for line in lines)


def models_of(run: Run) -> list[str]:
    """The models and readers, with versions, that labelled the run's demonstrations."""
    return sorted({str(learned["labels_from"]) for learned in run.learned.values()})


def solved_table(run: Run) -> str:
    """Mean ± sd of solved tasks per seed, with the 95 % interval of the share of all tries.

    A table for every group of families with the same approaches and number of tasks.
    """
    return "\n".join(_solved_of(run, group) for group in run.suite.groups())


def _solved_of(run: Run, group: Sequence[FamilyEntry]) -> str:
    families = [f.name for f in group]
    rows = [[a, *(_solved(cell_of(run.rows, a, f, v)) for f in families for v in run.suite.values)]
            for a in run.suite.approaches_of(group[0])]  # fmt: skip
    values = [f"{f} {v:g}" if v is not None else f for f in families for v in run.suite.values]
    tasks = run.suite.tasks_of(group[0])
    said = f"Of {tasks} tasks per seed:\n\n" if tasks != run.suite.tasks else ""
    return said + markdown(["approach", *values], rows)


def _solved(found: TableCell | TryOutcome | None) -> str:
    if not isinstance(found, TableCell):
        return found.value if found else "not run"
    return f"{found.text} [{100 * found.interval.low:.0f}, {100 * found.interval.high:.0f}] %"


def only_finished(run: Run) -> Run:
    """The run without the rows of cells in which some seed lacks a try: a mean over fewer would mislead."""
    counts = Counter((r.approach, r.family, r.value) for r in run.rows if r.task is not None)
    full = {f.name: len(run.suite.seeds) * run.suite.tasks_of(f) for f in run.suite.families}
    kept = tuple(r for r in run.rows if r.task is None or counts[r.approach, r.family, r.value] == full[r.family])
    return replace(run, rows=kept)


def sweep_tables(run: Run) -> str:
    """A table per family with the values of the axis below one another."""
    assert run.suite.axis is not None, "the suite sweeps an axis"
    parts = []
    for entry in run.suite.families:
        rows = [
            [f"{value:g}", *(_solved(cell_of(run.rows, a, entry.name, value)) for a in run.suite.approaches)]
            for value in run.suite.values
            if value is not None
        ]
        parts.append(f"{entry.name}:\n\n" + markdown([run.suite.axis.of, *run.suite.approaches], rows))
    return "\n".join(parts)


def failure_table(run: Run) -> str:
    """Where the failures of every approach come from, over all families, and wrong labels at test time."""
    rows = []
    for approach in run.suite.approaches:
        cells = [cell_of(run.rows, approach, f.name, v) for f in run.suite.families for v in run.suite.values]
        tried = [c for c in cells if isinstance(c, TableCell)]
        if tried:
            causes = sum((c.failures for c in tried), Counter[str]())
            labels, errors = sum(c.labels for c in tried), sum(c.label_errors for c in tried)
            failures = ", ".join(f"{cause or 'unknown'} {n}" for cause, n in sorted(causes.items())) or "none"
            rows.append([approach, str(sum(c.tries for c in tried)), failures, f"{errors} of {labels}"])
    return markdown(["approach", "tries", "failures by cause", "wrong labels at test time"], rows)


def learned_table(run: Run) -> str:
    """What was selected and learned, by family and approach."""
    rows = []
    for entry in run.suite.families:
        for approach in run.suite.approaches:
            found = [d for place, d in run.learned.items() if "selected" in d
                     and place.split("/")[0] == entry.name and place.rsplit("/", 1)[1] == approach]  # fmt: skip
            if found:
                sizes = sorted({len(d["selected"]) for d in found})
                sets = {", ".join(f"`{name}`" for name in d["selected"]) for d in found}
                names = sets.pop() if len(sets) == 1 and sizes[-1] <= 5 else f"{_range(sizes)} predicates"
                errors = [d for d in found if d.get("labels")]
                share = sum(d["label_errors"] for d in errors) / max(1, sum(d["labels"] for d in errors))
                rows.append([
                    entry.name, approach, _range([d["candidates"] for d in found]), names or "none",
                    _range([d["operators"] for d in found]), f"{100 * share:.2f} %" if errors else "-",
                ])  # fmt: skip
    headings = ["family", "approach", "candidates", "selected", "operators", "wrong labels in demonstrations"]
    return markdown(headings, rows)


def _range(numbers: Sequence[int]) -> str:
    low, high = min(numbers), max(numbers)
    return str(low) if low == high else f"{low} to {high}"


def claims_table(judged: Sequence[Judged]) -> str:
    """One row per published claim."""
    rows = [
        [j.claim.text, j.claim.source, j.verdict.value,
         "; ".join(f"{f}: {v.value}{f' ({text})' if text else ''}" for f, (v, text) in j.families.items()) or "-"]
        for j in judged
    ]  # fmt: skip
    return markdown(["claim", "source", "verdict", "by family"], rows)


def printed_table(printed: Printed, run: Run) -> str:
    """The robot domains as printed: a row per domain and approach, solved tasks of all that were tried."""
    rows = []
    for domain, by_approach in printed.numbers.items():
        for approach, numbers in by_approach.items():
            cells = [cell_of(run.rows, approach, f"{domain}-{v}") for v in printed.variants]
            told = [f"{_counted(c)} [{n}/{printed.of}]" for c, n in zip(cells, numbers, strict=True)]
            rows.append([f"{domain}, {approach}", *told])
    return markdown(["", *printed.variants], rows)


def _counted(found: TableCell | TryOutcome | None) -> str:
    if not isinstance(found, TableCell):
        return found.value if found else "not run"
    return f"{found.solved} of {found.tries}"


def interim_table(published: Published, run: Run) -> str:
    """One row per interim number."""
    rows = [[f, a, v.value, text] for f, a, v, text in judge_interim(published.interim, run)]
    return markdown(["family", "approach", "verdict", "figures"], rows)


def summary(run: Run, *, date: str, command: str, chart: str | None) -> str:
    """What was solved, headed by where it comes from."""
    seeds = ", ".join(map(str, run.suite.seeds))
    tried, wanted = sum(row.task is not None for row in run.rows), expected(run)
    run = only_finished(run)
    unfinished = f"**Unfinished: {tried} of {wanted} tries.** Figures are of finished cells alone. "
    parts = [
        f"{unfinished if tried < wanted else ''}`{command}` ({date}): {run.suite.about}. Seeds {seeds}, "
        f"{run.suite.tasks} tasks each, open loop, one plan per task. Labels: {', '.join(models_of(run)) or 'none'}.\n",
        f"Solved of {run.suite.tasks} per seed: mean ± standard deviation over seeds, and the 95 % interval (Wilson) "
        "of the share of all tries.\n",
        sweep_tables(run) if run.suite.axis else solved_table(run),
    ]
    if chart:
        parts.append(f"![{run.suite.about}]({chart})\n")
    return "\n".join(parts)


def section(run: Run, published: Published, *, date: str, command: str, chart: str | None) -> str:
    """All that is reported of a run."""
    parts = [summary(run, date=date, command=command, chart=chart)]
    run = only_finished(run)
    parts += ["Where failures come from (planned again, then learned again, with true labels):\n", failure_table(run)]
    if not run.suite.axis:
        parts += ["What was learned:\n", learned_table(run)]
        parts += ["Published claims:\n", claims_table([judge(c, run) for c in published.claims])]
        about = published.interim.about
        robot = {f"{d}-{v}" for d in published.robot.numbers for v in published.robot.variants}
        if robot & {f.name for f in run.suite.families}:
            parts += [f"{published.robot.about}\n", printed_table(published.robot, run)]
        parts += [f"{about} A number holds when the ranges mean ± sd overlap.\n", interim_table(published, run)]
    return "\n".join(parts)


def summary_csv(run: Run) -> str:
    """One line per approach, family and value."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(["approach", "family", "value", "outcome", "tries", "solved", "mean", "sd", "low95", "high95"])
    for approach in run.suite.approaches:
        for entry in (f for f in run.suite.families if approach in run.suite.approaches_of(f)):
            for value in run.suite.values:
                found = cell_of(run.rows, approach, entry.name, value)
                key = [approach, entry.name, "" if value is None else f"{value:g}"]
                if isinstance(found, TableCell):
                    figures = [found.mean, found.sd, found.interval.low, found.interval.high]
                    writer.writerow([*key, "tried", found.tries, found.solved, *(f"{x:.4f}" for x in figures)])
                else:
                    writer.writerow([*key, found.value if found else "not run", 0, 0, "", "", "", ""])
    return buffer.getvalue()


def comparison(left: Run, right: Run) -> str:
    """Two runs side by side: tries both made of the same task, how many only one solved, and a paired test."""
    rows = []
    key = attrgetter("approach", "family", "value", "seed", "task")
    others = {key(r): r for r in right.rows if r.outcome.scored}
    groups: dict[tuple[str, str], list[tuple[bool, bool]]] = {}
    for row in left.rows:
        if row.outcome.scored and (other := others.get(key(row))):
            pair = (row.outcome == TryOutcome.SOLVED, other.outcome == TryOutcome.SOLVED)
            groups.setdefault((row.approach, row.family), []).append(pair)
    for (approach, family), pairs in groups.items():
        only_left = sum(a and not b for a, b in pairs)
        only_right = sum(b and not a for a, b in pairs)
        a, b = sum(p[0] for p in pairs), sum(p[1] for p in pairs)
        p = sign_test(only_left, only_right)
        rows.append([approach, family, f"{a} of {len(pairs)}", f"{b} of {len(pairs)}", str(only_left), str(only_right),
                     f"{p:.3f}"])  # fmt: skip
    return markdown(["approach", "family", "A", "B", "only A solved", "only B solved", "p (sign test)"], rows)
