"""The published claims beside what was measured: holds, does not hold, needs a model, or not run (method 11)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from importlib.resources import files
from typing import Annotated, Any, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field

from pix2pred.benchmark.rows import Row, TryOutcome
from pix2pred.benchmark.runner import Run
from pix2pred.benchmark.statistics import TableCell, cell, cell_of


class ClaimVerdict(StrEnum):
    """What became of a claim."""

    HOLDS = "holds"
    FAILS = "does not hold"
    NEEDS_MODEL = "needs a model"
    NOT_RUN = "not run"


class _Claim(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    id: str
    source: str
    text: str
    families: tuple[str, ...] | None = None
    excluded: tuple[str, ...] = Field((), alias="except")


class _Pair(_Claim):
    better: str
    worse: str


class Above(_Pair):
    """The better one's mean is strictly larger."""

    kind: Literal["above"]


class Comparable(_Pair):
    """The means differ by at most ``margin`` tasks."""

    kind: Literal["comparable"]
    margin: float


class _Single(_Claim):
    approach: str


class NearZero(_Single):
    """The mean is at most ``bound`` tasks."""

    kind: Literal["near-zero"]
    bound: float


class NoneOfSecondHalf(_Single):
    """No task of the second half of a seed's tasks is solved."""

    kind: Literal["none-of-second-half"]


class PoolSize(_Single):
    """The pool has at least ``bound`` candidates in some seed."""

    kind: Literal["pool-size"]
    bound: int


class SetSize(_Single):
    """So many visual and feature predicates are selected in most seeds."""

    kind: Literal["set-size"]
    sizes: dict[str, dict[str, int]]


class MainCause(_Single):
    """More than half of the failures have this cause."""

    kind: Literal["main-cause"]
    cause: str


Claim = Annotated[
    Above | Comparable | NearZero | NoneOfSecondHalf | PoolSize | SetSize | MainCause, Field(discriminator="kind")
]


class Interim(BaseModel):
    """Numbers that were never published, by approach: mean and sd per family."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    source: str
    about: str
    families: tuple[str, ...]
    numbers: dict[str, tuple[tuple[float, float], ...]]


class Printed(BaseModel):
    """The printed table of the robot domains: correct plans of ``of`` by domain, approach and variant."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    source: str
    about: str
    of: int
    variants: tuple[str, ...]
    numbers: dict[str, dict[str, tuple[int, ...]]]


class Published(BaseModel):
    """The file ``claims.yaml``."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    claims: tuple[Claim, ...]
    interim: Interim
    robot: Printed


def load_claims() -> Published:
    """The claims that come with the package."""
    text = (files("pix2pred.benchmark") / "claims.yaml").read_text(encoding="utf-8")
    return Published.model_validate(yaml.safe_load(text))


@dataclass(frozen=True, slots=True)
class Judged:
    """A claim's verdict, and per family the verdict with its figures."""

    claim: Any
    verdict: ClaimVerdict
    families: Mapping[str, tuple[ClaimVerdict, str]]


def judge(claim: Any, run: Run) -> Judged:
    """What the run says about ``claim``, over the families that the claim and the suite share.

    A claim that names no family is about those of the suite's first group: the simulated ones of the published
    comparison, where the robot's come after them.
    """
    wanted = claim.families or [f.name for f in run.suite.groups()[0]]
    names = [f.name for f in run.suite.families if f.name in wanted and f.name not in claim.excluded]
    checks: dict[type, Callable[[Any, Run, str], tuple[ClaimVerdict, str]]] = {
        Above: _above, Comparable: _comparable, NearZero: _near_zero, NoneOfSecondHalf: _second_half,
        PoolSize: _pool_size, SetSize: _set_size, MainCause: _main_cause,
    }  # fmt: skip
    found = {name: checks[type(claim)](claim, run, name) for name in names}
    return Judged(claim, _overall([verdict for verdict, _ in found.values()]), found)


def judge_interim(interim: Interim, run: Run) -> list[tuple[str, str, ClaimVerdict, str]]:
    """(family, approach, verdict, figures): holds when the ranges mean ± sd overlap."""
    found = []
    for approach, numbers in interim.numbers.items():
        for family, (mean, sd) in zip(interim.families, numbers, strict=True):
            said = f"{mean:g} ± {sd:g}"
            measured = cell_of(run.rows, approach, family)
            if not isinstance(measured, TableCell):
                found.append((family, approach, _missing(measured), f"interim {said}"))
                continue
            ten = 10 / measured.per_seed
            near = abs(measured.mean * ten - mean) <= sd + measured.sd * ten + 1e-9
            figures = f"measured {measured.text}, interim {said}"
            found.append((family, approach, ClaimVerdict.HOLDS if near else ClaimVerdict.FAILS, figures))
    return found


def _overall(verdicts: Sequence[ClaimVerdict]) -> ClaimVerdict:
    """One failure refutes; what was not tried is said only when nothing was."""
    for verdict in (ClaimVerdict.FAILS, ClaimVerdict.HOLDS, ClaimVerdict.NEEDS_MODEL):
        if verdict in verdicts:
            return verdict
    return ClaimVerdict.NOT_RUN


def _missing(found: TableCell | TryOutcome | None) -> ClaimVerdict:
    return ClaimVerdict.NEEDS_MODEL if found == TryOutcome.NEEDS_MODEL else ClaimVerdict.NOT_RUN


def _verdict(holds: bool) -> ClaimVerdict:
    return ClaimVerdict.HOLDS if holds else ClaimVerdict.FAILS


def _pair(claim: _Pair, run: Run, family: str) -> tuple[TableCell, TableCell] | ClaimVerdict:
    cells = [cell_of(run.rows, name, family) for name in (claim.better, claim.worse)]
    better, worse = cells
    if isinstance(better, TableCell) and isinstance(worse, TableCell):
        return better, worse
    missing = [_missing(c) for c in cells if not isinstance(c, TableCell)]
    return ClaimVerdict.NOT_RUN if ClaimVerdict.NOT_RUN in missing else ClaimVerdict.NEEDS_MODEL


def _above(claim: Above, run: Run, family: str) -> tuple[ClaimVerdict, str]:
    pair = _pair(claim, run, family)
    if isinstance(pair, ClaimVerdict):
        return pair, ""
    better, worse = pair
    return _verdict(better.mean > worse.mean), f"{better.text} against {worse.text}"


def _comparable(claim: Comparable, run: Run, family: str) -> tuple[ClaimVerdict, str]:
    pair = _pair(claim, run, family)
    if isinstance(pair, ClaimVerdict):
        return pair, ""
    better, worse = pair
    return _verdict(abs(better.mean - worse.mean) <= claim.margin), f"{better.text} against {worse.text}"


def _near_zero(claim: NearZero, run: Run, family: str) -> tuple[ClaimVerdict, str]:
    found = cell_of(run.rows, claim.approach, family)
    if not isinstance(found, TableCell):
        return _missing(found), ""
    return _verdict(found.mean <= claim.bound), found.text


def _second_half(claim: NoneOfSecondHalf, run: Run, family: str) -> tuple[ClaimVerdict, str]:
    half: list[Row] = []
    for seed in run.suite.seeds:
        rows = [r for r in run.rows if (r.approach, r.family, r.seed) == (claim.approach, family, seed)]
        half += rows[(len(rows) + 1) // 2 :] if len(rows) > 1 else rows
    found = cell(half)
    if not isinstance(found, TableCell):
        return _missing(found), ""
    return _verdict(found.solved == 0), f"{found.solved} of {found.tries}"


def _learned(run: Run, approach: str, family: str) -> list[dict[str, Any]]:
    places = [f"{family}/seed{seed}/{approach}" for seed in run.suite.seeds]
    return [run.learned[p] for p in places if "selected" in run.learned.get(p, {})]


def _pool_size(claim: PoolSize, run: Run, family: str) -> tuple[ClaimVerdict, str]:
    sizes = [learned["candidates"] for learned in _learned(run, claim.approach, family)]
    if not sizes:
        return ClaimVerdict.NOT_RUN, ""
    return _verdict(max(sizes) >= claim.bound), f"{min(sizes)} to {max(sizes)} candidates"


def _set_size(claim: SetSize, run: Run, family: str) -> tuple[ClaimVerdict, str]:
    found = Counter(
        (learned["visual"], len(learned["selected"]) - learned["visual"])
        for learned in _learned(run, claim.approach, family)
    )
    if not found or family not in claim.sizes:
        return ClaimVerdict.NOT_RUN, ""
    wanted = (claim.sizes[family]["visual"], claim.sizes[family]["feature"])
    text = "; ".join(f"{v} visual and {f} feature ({n}x)" for (v, f), n in sorted(found.items()))
    return _verdict(2 * found[wanted] > found.total()), text


def _main_cause(claim: MainCause, run: Run, family: str) -> tuple[ClaimVerdict, str]:
    found = cell_of(run.rows, claim.approach, family)
    if not isinstance(found, TableCell):
        return _missing(found), ""
    if not found.failures:
        return ClaimVerdict.NOT_RUN, "no failures"
    text = ", ".join(f"{cause} {n}" for cause, n in found.failures.most_common())
    return _verdict(2 * found.failures[claim.cause] > found.failures.total()), text
