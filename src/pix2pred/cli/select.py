"""``select``: symbolic labels in, predicates and operators out; no pictures needed."""

from __future__ import annotations

import json as json_module
import time
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Annotated, Any

from cyclopts import Parameter
from pydantic import ValidationError

from pix2pred.cli.console import bars, err, print_json
from pix2pred.cli.ranges import WORKERS, between, output_file, output_folder
from pix2pred.learning import (
    LearningSettings,
    Selection,
    Traces,
    TracesError,
    hill_climbing,
    load_traces,
    selection_document,
)
from pix2pred.planning.pddl.write import write_domain, write_problem
from pix2pred.structs import Predicate, WorldModel
from pix2pred.structs.formats.names import UnknownNameError
from pix2pred.system.errors import first_fault
from pix2pred.system.files import write_whole
from pix2pred.system.parallel import Backend, Workers

DEFAULTS = LearningSettings()


# Longer than others: every option is a line, with its help.
def select(
    file: Annotated[Path, Parameter(help="Traces file: labelled demonstrations, .json or .json.gz.")],
    /,
    *,
    out: Annotated[
        Path, Parameter(help="File to write, e.g. selection.json; timings.json goes beside it.", validator=output_file)
    ],
    pddl: Annotated[
        Path | None, Parameter(help="Folder for domain.pddl and a problem per demonstration.", validator=output_folder)
    ] = None,
    score: Annotated[str | None, Parameter(help="Score this set (A,B; empty: none) instead of searching.")] = None,
    tie_seeds: Annotated[
        int, Parameter(help="With --score: min, median, max of J over this many seeds.", validator=between(0, 10_000))
    ] = 0,
    chosen: Annotated[LearningSettings, Parameter(name="*", group="Settings, over those in the file")] = DEFAULTS,
    jobs: Annotated[
        int, Parameter(help="Workers that share the planning searches; the result is the same.", validator=WORKERS)
    ] = 1,
    backend: Annotated[Backend, Parameter(help="Engine of the workers; dask and ray are extras.")] = Backend.LOKY,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
) -> int:
    """Select predicates and learn operators from labelled demonstrations in a traces file (.json or .json.gz).

    For example:

    - `pix2pred select labels.json.gz --out selection.json --pddl pddl`
    - `pix2pred select labels.json.gz --out selection.json --operators robust --jobs 8`
    """
    if out.name == "timings.json" or (out.parent / "config.yaml").exists():
        raise TracesError(f"--out {out}: timings.json beside it would overwrite other results; choose another place")
    if (score is None and tie_seeds) or (score is not None and pddl is not None):
        raise TracesError("--tie-seeds goes with --score, and --pddl goes without it")
    traces = load_traces(file)
    settings = _settings(file, traces, {name: getattr(chosen, name) for name in chosen.model_fields_set})
    wall, cpu = time.perf_counter(), time.process_time()
    with bars() as progress:
        if score is not None:
            document, scored = _score(traces, settings, score, tie_seeds), 1
        else:
            with Workers(jobs, backend).ready() as apply:
                climb = hill_climbing(traces.table, settings, apply)
                selection = climb.run(progress)
            document, scored = selection_document(selection, settings), selection.scored
    seconds = {"cpu": time.process_time() - cpu, "wall": time.perf_counter() - wall}
    _write(out, document)
    _write(out.with_name("timings.json"), {**{k: round(v, 4) for k, v in seconds.items()}, "scored": scored})
    if pddl is not None and score is None:
        _write_pddl(pddl, traces, selection)
    if json:
        print_json(document | {"seconds": round(seconds["cpu"], 4)})
    else:
        err.print(f"{out} written, {seconds['cpu']:.2f} CPU seconds", markup=False)
    return 0


def _settings(file: Path, traces: Traces, options: dict[str, Any]) -> LearningSettings:
    try:
        return LearningSettings.model_validate({**traces.settings, **options})
    except ValidationError as error:
        where, first = first_fault(error)
        place = f"--{where.replace('_', '-')}" if where in options else f"{file}: $.settings.{where}"
        raise TracesError(f"{place}: {first['msg']}, found {first['input']!r}") from error


def _score(traces: Traces, settings: LearningSettings, names: str, tie_seeds: int) -> dict[str, Any]:
    """J of the named set, in the default engine and, if asked for, over tie seeds of the search to the letter."""
    pool = {c.predicate.name: c.predicate for c in traces.table.pool}
    chosen: list[Predicate] = []
    for name in filter(None, (part.strip() for part in names.split(","))):
        if name not in pool:
            raise UnknownNameError("candidate", name, pool)
        if pool[name] not in chosen:
            chosen.append(pool[name])
    document: dict[str, Any] = {"scored": [p.name for p in chosen], "J": round(_j(traces, settings, chosen), 4)}
    if tie_seeds:
        seeds = [
            settings.model_copy(update={"engine": "exact-tree", "tie_seed": settings.tie_seed + i})
            for i in range(tie_seeds)
        ]
        js = sorted(_j(traces, seeded, chosen) for seeded in seeds)
        document["J_over_tie_seeds"] = {
            "seeds": tie_seeds, "minimum": round(js[0], 4), "median": round(median(js), 4), "maximum": round(js[-1], 4),
        }  # fmt: skip
    return document | {"settings": settings.model_dump(mode="json")}


def _j(traces: Traces, settings: LearningSettings, chosen: Sequence[Predicate]) -> float:
    climb = hill_climbing(traces.table, settings)
    try:
        return climb.score(chosen).total
    except ValueError as error:
        raise TracesError(f"--score: {error}") from error


def _write(path: Path, document: dict[str, Any]) -> None:
    write_whole(path, (json_module.dumps(document, indent=1) + "\n").encode())


def _write_pddl(directory: Path, traces: Traces, selection: Selection) -> None:
    model = WorldModel(traces.vocabulary, selection.selected, selection.operators, "traces")
    write_whole(directory / "domain.pddl", write_domain(model).encode())
    for demo in traces.table.demos:
        initial = demo.restricted(model.predicates).abstract_states()[0]
        text = write_problem(model, demo.name, demo.objects, initial, *demo.goals)
        write_whole(directory / f"{demo.name}.pddl", text.encode())
