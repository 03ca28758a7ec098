"""Suites are data: which approaches, families, seeds and settings a benchmark runs."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from importlib.resources import files
from pathlib import Path
from typing import Any

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from pix2pred.planning import AStar, Bounded, GreedyBestFirst, Planner, Portfolio
from pix2pred.settings import Layer, Settings, of_project, resolve
from pix2pred.structs.formats.names import UnknownNameError
from pix2pred.system.errors import Pix2predError, first_fault

_SUITES = files("pix2pred.benchmark") / "suites"


class SuiteError(Pix2predError, ValueError):
    """A suite that cannot be run; the message says where and why."""


class Budgets(BaseModel):
    """Limits of one search for a plan at test time. Beyond any of them the outcome is ``budget``."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    ground_operators: int = Field(50_000, ge=1, description="reachable ground operators")
    optimal_nodes: int = Field(5_000, ge=1, description="created nodes of A* with LM-cut, which is tried first")
    nodes: int = Field(200_000, ge=1, description="created nodes of greedy search with FF")
    megabytes: int = Field(500, ge=1, description="memory of the created nodes")
    operator_visits: int = Field(50_000_000, ge=1, description="created nodes times ground operators")

    def planner(self) -> Planner:
        """Optimal where that is cheap, greedy otherwise."""

        def bounded(nodes: int) -> Portfolio:
            return Portfolio((AStar(max_nodes=min(nodes, self.optimal_nodes)), GreedyBestFirst(max_nodes=nodes)))

        search = Bounded(bounded, self.nodes, self.megabytes, self.operator_visits)
        return Planner(search, max_operators=self.ground_operators)


class FamilyEntry(BaseModel):
    """A task family. ``family`` absent means the first one of the domain."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str = Field(pattern=r"^[a-z0-9][a-z0-9\-]*$", description="what rows and claims call it")
    domain: str
    family: str | None = None
    settings: dict[str, Any] = Field(default_factory=dict, description="as in a project's settings, by section")
    shown_demos: int | None = Field(None, ge=1, description="demonstrations that a planning prompt shows at most")
    approaches: tuple[str, ...] | None = Field(
        None, min_length=1, description="tried here; by default all of the suite"
    )
    tasks: int | None = Field(
        None, ge=1, description="test tasks per seed; by default as many as of the other families"
    )

    @model_validator(mode="after")
    def _check_settings(self) -> FamilyEntry:
        Settings.model_validate(self.settings)
        return self


class Varied(StrEnum):
    """What a sweep can vary."""

    DEMONSTRATIONS = "demonstrations"
    """How many of them are learned from."""
    ITEMS = "items"
    """Movable things in the test scenes."""
    POOL = "pool"
    """How many visual candidates are left, drawn at random by the
    seed of the cell."""
    LABEL_NOISE = "label-noise"
    """The share of labels turned round."""


class Axis(BaseModel):
    """What a sweep varies, and the values it takes."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    of: Varied
    values: tuple[float, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _check_values(self) -> Axis:
        counts = self.of is not Varied.LABEL_NOISE
        if any((v < 1 or v != int(v)) if counts else not 0 <= v < 1 for v in self.values):
            raise ValueError(f"values of {self.of} are {'whole numbers from 1' if counts else 'shares below 1'}")
        return self


class Suite(BaseModel):
    """A benchmark: every approach on every family, seed and value of the axis."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    about: str
    approaches: tuple[str, ...] = Field(min_length=1)
    families: tuple[FamilyEntry, ...] = Field(min_length=1)
    seeds: tuple[int, ...] = Field(min_length=1)
    tasks: int = Field(10, ge=1, description="test tasks per seed")
    budgets: Budgets = Field(default_factory=Budgets)
    settings: dict[str, Any] = Field(default_factory=dict, description="settings of all families, by section")
    axis: Axis | None = None

    @model_validator(mode="after")
    def _check(self) -> Suite:
        for what, found in (
            ("approach", self.approaches),
            ("family", [f.name for f in self.families]),
            ("seed", self.seeds),
        ):
            twice = [x for i, x in enumerate(found) if x in found[:i]]
            if twice:
                raise ValueError(f"{what} {twice[0]!r} is listed twice")
        for entry in self.families:
            unknown = [a for a in entry.approaches or () if a not in self.approaches]
            if unknown:
                raise ValueError(f"family {entry.name!r} names {unknown[0]!r}, which is no approach of the suite")
        return self

    @property
    def values(self) -> tuple[float | None, ...]:
        """The values of the axis, or None once."""
        return self.axis.values if self.axis else (None,)

    def approaches_of(self, entry: FamilyEntry) -> tuple[str, ...]:
        """The approaches that are compared on a family."""
        return entry.approaches or self.approaches

    def tasks_of(self, entry: FamilyEntry) -> int:
        """The test tasks per seed of a family."""
        return entry.tasks or self.tasks

    def groups(self) -> list[list[FamilyEntry]]:
        """The families in the order of the suite, together with those that have the same approaches and tasks."""
        found: dict[tuple[tuple[str, ...], int], list[FamilyEntry]] = {}
        for entry in self.families:
            found.setdefault((self.approaches_of(entry), self.tasks_of(entry)), []).append(entry)
        return list(found.values())

    def document(self) -> dict[str, Any]:
        """The suite as a run folder keeps it; what a family leaves to the suite is not in it."""
        made = self.model_dump(mode="json")
        for entry in made["families"]:
            for key in ("approaches", "tasks"):
                if entry[key] is None:
                    del entry[key]
        return made

    def settings_of(self, entry: FamilyEntry, learning: Mapping[str, Any]) -> Settings:
        """The settings of a family: its domain's for ``learning``, then the suite's, then its own in this suite."""
        suite, family = Layer(self.settings, f"suite {self.name}"), Layer(entry.settings, f"family {entry.name}")
        return resolve(of_project({"learning": learning}), suite, family)


def suite_names() -> list[str]:
    """The suites that come with the package."""
    return sorted(p.name.removesuffix(".yaml") for p in _SUITES.iterdir() if p.name.endswith(".yaml"))


def load_suite(name: str) -> Suite:
    """A suite by name, or from the YAML file ``name``. Raises ``SuiteError`` or ``UnknownNameError``."""
    if name.endswith((".yaml", ".yml")):
        try:
            text = Path(name).read_text(encoding="utf-8")
        except OSError as error:
            raise SuiteError(f"{name}: cannot be read ({error.strerror})") from error
    elif name in suite_names():
        text = (_SUITES / f"{name}.yaml").read_text(encoding="utf-8")
    else:
        raise UnknownNameError("suite", name, suite_names(), listed=True)
    try:
        return Suite.model_validate(yaml.safe_load(text))
    except yaml.YAMLError as error:
        raise SuiteError(f"{name}: is no YAML file ({' '.join(str(error).split())[:200]})") from error
    except ValidationError as error:
        where, first = first_fault(error)
        raise SuiteError(f"{name}: {where or 'suite'}: {first['msg']} (found {str(first['input'])[:80]})") from error
