"""What the axis of a sweep does to a cell."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from pix2pred.approaches.approach import Approach, Composition
from pix2pred.benchmark.suite import Axis, Varied
from pix2pred.structs import Demo
from pix2pred.structs.environment import Domain, NeedsMore, SimulatedTask, Sized
from pix2pred.structs.formats.names import UnknownNameError
from pix2pred.system.errors import Pix2predError
from pix2pred.vlm import VLM
from pix2pred.vlm.noise.flips import FlippingVLM


class NotAvailableError(Pix2predError, LookupError):
    """A cell that cannot be run here; the message says why."""


def installed(name: str, find: Callable[[str], Domain]) -> Domain:
    """The domain called ``name``, with everything it needs to run. Raises ``NotAvailableError``."""
    try:
        domain = find(name)
        if isinstance(domain, NeedsMore):
            domain.check_installed()
    except (UnknownNameError, ImportError) as error:
        raise NotAvailableError(f"domain {name!r} is not installed ({error})") from error
    return domain


@dataclass(frozen=True, slots=True)
class Setting:
    """What a cell is about: varied by a sweep, as it is otherwise."""

    approach: Approach
    demos: Sequence[Demo]
    vlm: VLM


def vary(setting: Setting, axis: Axis | None, value: float | None, seed: int) -> Setting:
    """``setting`` at ``value`` of ``axis``. Raises ``NotAvailableError``."""
    if axis is None or value is None or axis.of is Varied.ITEMS:
        return setting
    match axis.of:
        case Varied.DEMONSTRATIONS:
            if value > len(setting.demos):
                raise NotAvailableError(f"the family has {len(setting.demos)} demonstrations")
            return replace(setting, demos=setting.demos[: int(value)])
        case Varied.POOL:
            if not isinstance(setting.approach, Composition):
                raise NotAvailableError(f"{setting.approach.name} has no pool of candidates")
            return replace(setting, approach=setting.approach.limited(int(value), seed))
        case Varied.LABEL_NOISE:
            return replace(setting, vlm=FlippingVLM(setting.vlm, value, seed)) if value else setting


def tasks_for(
    domain: Domain, family: str, seed: int, count: int, axis: Axis | None, value: float | None
) -> Sequence[SimulatedTask]:
    """The test tasks of a cell. Raises ``NotAvailableError``."""
    if axis is None or value is None or axis.of is not Varied.ITEMS:
        return domain.tasks(family, seed, count)
    if not isinstance(domain, Sized):
        raise NotAvailableError(f"{domain.name} makes no tasks of a chosen size")
    try:
        return domain.sized_tasks(family, seed, count, int(value))
    except ValueError as error:
        raise NotAvailableError(str(error)) from error
