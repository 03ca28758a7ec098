"""Episodes as strips: every skill with what it was expected to change and, if somebody looked, what was seen to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pix2pred.structs import Object, Operator
from pix2pred.structs.plans import effects, signed
from pix2pred.structs.predicates import parse_application


@dataclass(frozen=True, slots=True)
class PlanStep:
    """A skill of an episode. Changes have a sign; ``observed`` is None where nobody looked."""

    action: str
    operator: str
    status: str
    detail: str
    expected: tuple[str, ...]
    observed: tuple[str, ...] | None

    @property
    def surprises(self) -> tuple[str, ...]:
        """Expected changes that were not seen."""
        return () if self.observed is None else tuple(c for c in self.expected if c not in self.observed)


@dataclass(frozen=True, slots=True)
class EpisodeView:
    """One task. ``rests_on`` are the visual labels of the first state that the plan was made from."""

    task: str
    solved: bool
    failure: str
    detail: str
    steps: tuple[PlanStep, ...]
    rests_on: tuple[str, ...]
    label_errors: tuple[str, ...]
    nodes: int | None
    replans: int


def episodes(summary: Mapping[str, Any], operators: Mapping[str, Operator]) -> list[EpisodeView]:
    """The episodes of one ``summary.json``."""
    return [
        EpisodeView(
            e["task"], bool(e["solved"]), e["failure"] or "", e["detail"],
            tuple(_step(s, operators) for s in e["steps"])
            or tuple(PlanStep(a, "", "", "", (), None) for a in e["plan"]),
            tuple(e["true_visual_labels"]), tuple(e["label_errors"]), e["nodes"], e["replans"],
        )
        for e in summary["episodes"]
    ]  # fmt: skip


def _step(step: Mapping[str, Any], operators: Mapping[str, Operator]) -> PlanStep:
    observed = step.get("observed")
    return PlanStep(
        step["action"], step["operator"], step["status"], step["detail"],
        _expected(step["operator"], operators), None if observed is None else tuple(observed),
    )  # fmt: skip


def _expected(text: str, operators: Mapping[str, Operator]) -> tuple[str, ...]:
    """The effects of a ground operator written as ``Op0(a, b)``; none when the model has changed since."""
    try:
        parsed = parse_application(text)
    except ValueError:
        return ()
    operator = operators.get(parsed.name)
    if operator is None or len(operator.parameters) != len(parsed.args):
        return ()
    objects = tuple(Object(name, v.type) for name, v in zip(parsed.args, operator.parameters, strict=True))
    return signed(effects(operator.ground(objects)))
