"""The published claims beside what was measured: holds, does not hold, needs a model, or not run (method 11)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Mapping, Sequence
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


Checked = tuple[ClaimVerdict, str]
"""What a family says about a claim, and the figures."""


class _Claim(BaseModel, ABC):
    model_config = ConfigDict(extra="forbid", frozen=True)

    id: str
    source: str
    text: str
    families: tuple[str, ...] | None = None
    excluded: tuple[str, ...] = Field((), alias="except")

    @abstractmethod
    def check(self, run: Run, family: str) -> Checked:
        """What ``family`` says about the claim. Raises ``_NotMeasuredError``."""


class _Pair(_Claim):
    better: str
    worse: str

    def figures(self, run: Run, family: str) -> tuple[float, float, str]:
        """Both means, and what is said of them. Raises ``_NotMeasuredError``."""
        better, worse = _measured([cell_of(run.rows, name, family) for name in (self.better, self.worse)])
        return better.mean, worse.mean, f"{better.text} against {worse.text}"


class Above(_Pair):
    """The better one's mean is strictly larger."""

    kind: Literal["above"]

    def check(self, run: Run, family: str) -> Checked:
        better, worse, text = self.figures(run, family)
        return _verdict(better > worse), text


class Comparable(_Pair):
    """The means differ by at most ``margin`` tasks."""

    kind: Literal["comparable"]
    margin: float

    def check(self, run: Run, family: str) -> Checked:
        better, worse, text = self.figures(run, family)
        return _verdict(abs(better - worse) <= self.margin), text


class _Single(_Claim):
    approach: str

    def learned(self, run: Run, family: str) -> list[dict[str, Any]]:
        """What the approach learned, by seed. Raises ``_NotMeasuredError`` for none."""
        places = [f"{family}/seed{seed}/{self.approach}" for seed in run.suite.seeds]
        found = [run.learned[p] for p in places if "selected" in run.learned.get(p, {})]
        if not found:
            raise _NotMeasuredError(ClaimVerdict.NOT_RUN)
        return found


class NearZero(_Single):
    """The mean is at most ``bound`` tasks."""

    kind: Literal["near-zero"]
    bound: float

    def check(self, run: Run, family: str) -> Checked:
        (found,) = _measured([cell_of(run.rows, self.approach, family)])
        return _verdict(found.mean <= self.bound), found.text


class NoneOfSecondHalf(_Single):
    """No task of the second half of a seed's tasks is solved."""

    kind: Literal["none-of-second-half"]

    def check(self, run: Run, family: str) -> Checked:
        half: list[Row] = []
        for seed in run.suite.seeds:
            rows = [r for r in run.rows if (r.approach, r.family, r.seed) == (self.approach, family, seed)]
            half += rows[(len(rows) + 1) // 2 :] if len(rows) > 1 else rows
        (found,) = _measured([cell(half)])
        return _verdict(found.solved == 0), f"{found.solved} of {found.tries}"


class PoolSize(_Single):
    """The pool has at least ``bound`` candidates in some seed."""

    kind: Literal["pool-size"]
    bound: int

    def check(self, run: Run, family: str) -> Checked:
        sizes = [learned["candidates"] for learned in self.learned(run, family)]
        return _verdict(max(sizes) >= self.bound), f"{min(sizes)} to {max(sizes)} candidates"


class SetSize(_Single):
    """So many visual and feature predicates are selected in most seeds."""

    kind: Literal["set-size"]
    sizes: dict[str, dict[str, int]]

    def check(self, run: Run, family: str) -> Checked:
        learned = self.learned(run, family)
        if family not in self.sizes:
            return ClaimVerdict.NOT_RUN, ""
        found = Counter((one["visual"], len(one["selected"]) - one["visual"]) for one in learned)
        wanted = (self.sizes[family]["visual"], self.sizes[family]["feature"])
        text = "; ".join(f"{v} visual and {f} feature ({n}x)" for (v, f), n in sorted(found.items()))
        return _verdict(2 * found[wanted] > found.total()), text


class MainCause(_Single):
    """More than half of the failures have this cause."""

    kind: Literal["main-cause"]
    cause: str

    def check(self, run: Run, family: str) -> Checked:
        (found,) = _measured([cell_of(run.rows, self.approach, family)])
        if not found.failures:
            return ClaimVerdict.NOT_RUN, "no failures"
        text = ", ".join(f"{cause} {n}" for cause, n in found.failures.most_common())
        return _verdict(2 * found.failures[self.cause] > found.failures.total()), text


Claim = Annotated[
    Above | Comparable | NearZero | NoneOfSecondHalf | PoolSize | SetSize | MainCause, Field(discriminator="kind")
]


class _NotMeasuredError(Exception):
    """There is no try to judge by; ``verdict`` says why."""

    def __init__(self, verdict: ClaimVerdict) -> None:
        super().__init__(verdict)
        self.verdict = verdict


def _measured(found: Sequence[TableCell | TryOutcome | None]) -> list[TableCell]:
    """Cells with tries. Raises ``_NotMeasuredError`` when one has none."""
    missing = [_missing(c) for c in found if not isinstance(c, TableCell)]
    if missing:
        raise _NotMeasuredError(ClaimVerdict.NOT_RUN if ClaimVerdict.NOT_RUN in missing else ClaimVerdict.NEEDS_MODEL)
    return [c for c in found if isinstance(c, TableCell)]


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

    claim: Claim
    verdict: ClaimVerdict
    families: Mapping[str, Checked]


def judge(claim: Claim, run: Run) -> Judged:
    """What the run says about ``claim``, over the families that the claim and the suite share.

    A claim that names no family is about those of the suite's first group: the simulated ones of the published
    comparison, where the robot's come after them.
    """
    wanted = claim.families or [f.name for f in run.suite.groups()[0]]
    names = [f.name for f in run.suite.families if f.name in wanted and f.name not in claim.excluded]
    found = {name: _checked(claim, run, name) for name in names}
    return Judged(claim, _overall([verdict for verdict, _ in found.values()]), found)


def _checked(claim: Claim, run: Run, family: str) -> Checked:
    try:
        return claim.check(run, family)
    except _NotMeasuredError as error:
        return error.verdict, ""


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
