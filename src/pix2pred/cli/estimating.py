"""The settings of a project, and what learning from it would ask."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pix2pred.demos import Project
from pix2pred.pipeline import LearningProblem, ask
from pix2pred.registry import Registry
from pix2pred.settings import Layer, Settings, of_kind, of_project, resolve
from pix2pred.system.errors import Pix2predError
from pix2pred.vlm import AnswerStore
from pix2pred.vlm.control.estimate import EstimatingVLM
from pix2pred.vlm.control.guard import Expected


def project_settings(project: Project, *layers: Layer, begun: Sequence[Layer] = ()) -> Settings:
    """Defaults, or those of a run that was ``begun``, overridden by the project's own and then by ``layers``.

    Raises ``SettingsError``.
    """
    return resolve(of_kind(project.simulator), *begun, of_project(project.sections), *layers)


def estimated(registry: Registry, project: Project, settings: Settings, vlm: str, store: AnswerStore) -> dict[str, Any]:
    """What a run would ask, by stage and in all."""
    return _estimator(registry, project, settings, vlm, store).as_dict()


def expected(registry: Registry, project: Project, settings: Settings, vlm: str, store: AnswerStore) -> Expected | None:
    """What is still to be asked; ``None`` where a dry run ends with an error, which the run will meet itself."""
    try:
        return _estimator(registry, project, settings, vlm, store).expected()
    except Pix2predError:
        return None


def _estimator(registry: Registry, project: Project, settings: Settings, vlm: str, store: AnswerStore) -> EstimatingVLM:
    """What has counted every question that is not stored."""
    estimator = registry.estimator(vlm, (project.simulator or {}).get("domain"), store, settings.flow)
    ask(LearningProblem(project.vocabulary, project.demos, estimator, settings))
    return estimator
