"""Everything a run can be told, and the one way in which settings from several places are joined."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from pix2pred.demos import MOST_YAML_BYTES, YamlError, parse_yaml
from pix2pred.learning import LearningSettings
from pix2pred.learning.samplers.settings import SamplerSettings
from pix2pred.predicates import GrammarSettings, LabelSettings, ProposalSettings
from pix2pred.system.errors import Pix2predError, first_fault
from pix2pred.vlm import FlowSettings


class SettingsError(Pix2predError, ValueError):
    """Settings that do not exist or are out of range; the message says where they stand and what is expected."""


class Settings(BaseModel):
    """Everything a run can be told, by section. Frozen; the resolved settings are saved with every run."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    proposal: ProposalSettings = Field(default_factory=ProposalSettings)
    labels: LabelSettings = Field(default_factory=LabelSettings)
    grammar: GrammarSettings = Field(default_factory=GrammarSettings)
    learning: LearningSettings = Field(default_factory=LearningSettings)
    samplers: SamplerSettings = Field(default_factory=SamplerSettings)
    flow: FlowSettings = Field(default_factory=FlowSettings)


@dataclass(frozen=True, slots=True)
class Layer:
    """Settings from one place: values by section and name, and what to call the place in a message."""

    values: Mapping[str, Any]
    place: str


def resolve(*layers: Layer) -> Settings:
    """The settings of ``layers``, of which later ones win field by field; what none of them says has its default.

    Raises ``SettingsError``, which names the place and the field.
    """
    merged: dict[str, Any] = {}
    for layer in layers:
        for section, values in layer.values.items():
            both = isinstance(values, Mapping) and isinstance(merged.get(section), Mapping)
            merged[section] = {**merged[section], **values} if both else values
    try:
        return Settings.model_validate(merged)
    except ValidationError as error:
        where, first = first_fault(error)
        place = next((layer.place for layer in reversed(layers) if _says(layer.values, first["loc"])), "settings")
        raise SettingsError(f"{place}: {where}: {first['msg']} (found {first['input']!r})") from error


def _says(values: Mapping[str, Any], where: tuple[int | str, ...]) -> bool:
    """Whether ``values`` hold something at the section and field ``where``."""
    section = values.get(str(where[0])) if where else None
    return section is not None and (len(where) == 1 or not isinstance(section, Mapping) or where[1] in section)


def of_project(sections: Mapping[str, Mapping[str, Any]]) -> Layer:
    """What the sections ``learning``, ``proposal`` and ``labels`` of a project's ``domain.yaml`` say."""
    return Layer({name: dict(values) for name, values in sections.items()}, "the settings in domain.yaml")


def of_kind(simulator: Mapping[str, str] | None) -> Layer:
    """Defaults by kind of project: in one's own, without a ``simulator``, types are lifted.

    Projects of the bundled domains learn as published unless they say otherwise.
    """
    return Layer({"learning": {"lift_types": True}} if simulator is None else {}, "settings")


_DEFAULTS_OF_0_1: Mapping[str, Mapping[str, Any]] = {
    "learning": {"operators": "cluster-and-intersect", "lift_types": False},
    "labels": {"protocol": "published"},
}


def as_begun(config: Mapping[str, Any]) -> Layer:
    """The defaults with which the run of this ``config.yaml`` was begun: runs of version 0.1 go on as they were."""
    settings = config.get("settings")
    labels = settings.get("labels") if isinstance(settings, Mapping) else None
    is_newer = not isinstance(labels, Mapping) or "protocol" in labels
    return Layer({} if is_newer else _DEFAULTS_OF_0_1, "the defaults of version 0.1")


def default_of(key: str) -> Any:
    """The default of a setting by its dotted name, as files hold it; None when there is no such setting."""
    section, _, name = key.partition(".")
    return dict(Settings().model_dump(mode="json").get(section) or {}).get(name)


def of_options(section_and_name: Mapping[tuple[str, str], Any]) -> Layer:
    """What options of the command line say: values by (section, name); ``None`` stands for an option not given."""
    values: dict[str, dict[str, Any]] = {}
    for (section, name), value in section_and_name.items():
        if value is not None:
            values.setdefault(section, {})[name] = value
    return Layer(values, "options")


def of_file(path: Path) -> Layer:
    """What a YAML file says, by section; a name that only one section has may stand alone, as in ``operators: robust``.

    Raises ``SettingsError`` for a file that is no YAML mapping, and ``OSError`` for one that cannot be read.
    """
    with path.open("rb") as file:
        content = file.read(MOST_YAML_BYTES + 1)
    says_nothing = all(not line.strip() or line.lstrip().startswith(b"#") for line in content.splitlines())
    try:
        loaded = {} if says_nothing else parse_yaml(content).data
    except YamlError as error:
        raise SettingsError(f"{path}:{error.line}: {error.message}") from error
    if not isinstance(loaded, dict):
        raise SettingsError(f"{path}: expected settings such as 'learning: {{j_threshold: 100}}'")
    values: dict[str, Any] = {}
    for name, value in loaded.items():
        owners = [] if name in Settings.model_fields else _sections_with(str(name))
        if len(owners) > 1:
            raise SettingsError(f"{path}: {name}: say whose, as in '{owners[0]}: {{{name}: ...}}'; it is also in "
                                f"{', '.join(owners[1:])}")  # fmt: skip
        if owners:
            value, name = {name: value}, owners[0]
        both = isinstance(value, dict) and isinstance(values.get(name), dict)
        values[name] = {**values[name], **value} if both else value
    return Layer(values, str(path))


def _sections_with(name: str) -> list[str]:
    """The sections that have a field called ``name``."""
    found = []
    for section, field in Settings.model_fields.items():
        kind = field.annotation
        if isinstance(kind, type) and issubclass(kind, BaseModel) and name in kind.model_fields:
            found.append(section)
    return found
