"""Programs over object features: what feature predicates compute, and their text form.

The text is an s-expression: ``(<= robot.fingers 0.5)``, ``(not E)``, ``(forall E)``. Reading it never runs code.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pix2pred.structs.objects import Object, Type
from pix2pred.structs.states import State
from pix2pred.system.errors import Pix2predError


class ExpressionError(Pix2predError, ValueError):
    """A text that is no feature expression; the message says what was expected."""


@dataclass(frozen=True, slots=True)
class AtMost:
    """``x.feature <= bound`` for an object of exactly ``type_name``."""

    type_name: str
    feature: str
    bound: float

    def __str__(self) -> str:
        return f"(<= {self.type_name}.{self.feature} {self.bound!r})"


@dataclass(frozen=True, slots=True)
class Not:
    """The negation of ``inner``."""

    inner: Expression

    def __str__(self) -> str:
        return f"(not {self.inner})"


@dataclass(frozen=True, slots=True)
class ForAll:
    """``inner`` holds for every object of its type; takes no argument."""

    inner: Expression

    def __str__(self) -> str:
        return f"(forall {self.inner})"


Expression = AtMost | Not | ForAll


def evaluate(expression: Expression, state: State, args: tuple[Object, ...]) -> bool:
    """The value in ``state``; ``args`` has one object, or none for quantified expressions.

    Raises ``ExpressionError`` when the state lacks the feature.
    """
    match expression:
        case Not(inner):
            return not evaluate(inner, state, args)
        case ForAll(inner):
            over = _leaf(inner).type_name
            return all(evaluate(inner, state, (o,)) for o in sorted(state.features) if o.type.name == over)
        case AtMost(type_name, feature, bound):
            (thing,) = args
            if thing.type.name != type_name and feature not in thing.type.features:
                return False  # a subtype with other features
            if thing not in state.features or feature not in thing.type.features:
                raise ExpressionError(f"{thing.name} has no feature {feature!r} in this state (needed by {expression})")
            return bool(state.features[thing][thing.type.features.index(feature)] <= bound)


def arguments(expression: Expression, types: Mapping[str, Type]) -> tuple[Type, ...]:
    """The argument types of a predicate computed by ``expression``."""
    match expression:
        case ForAll():
            return ()
        case Not(inner):
            return arguments(inner, types)
        case AtMost(type_name):
            if type_name not in types:
                raise ExpressionError(f"type {type_name!r} of {expression} is not declared")
            return (types[type_name],)


def check_expression(name: str, expression: Expression, given: Sequence[str], types: Mapping[str, Type]) -> None:
    """Raise ``ExpressionError`` unless ``expression`` computes a predicate over arguments of types ``given``."""
    wanted = [t.name for t in arguments(expression, types)]
    if wanted != list(given):
        raise ExpressionError(f"predicate {name}: {expression} takes ({', '.join(wanted)}), not ({', '.join(given)})")
    leaf = _leaf(expression)
    holders = [t for t in types.values() if t.is_a(types[leaf.type_name])] if leaf.type_name in types else []
    if not any(leaf.feature in t.features for t in holders):
        raise ExpressionError(f"predicate {name}: no {leaf.type_name} has a feature {leaf.feature!r}")


def _leaf(expression: Expression) -> AtMost:
    return expression if isinstance(expression, AtMost) else _leaf(expression.inner)


_LEAF = re.compile(r"\(<=\s+([A-Za-z][\w\-]*)\.([\w\-]+)\s+([-+0-9.eE]+|inf|-inf)\)\Z")
_WRAPPED = re.compile(r"\((not|forall)\s+(\(.*\))\)\Z", re.DOTALL)
_MAX_DEPTH = 10


def parse_expression(text: str, depth: int = 0) -> Expression:
    """Read the text form. Raises ``ExpressionError``."""
    text = text.strip()
    if match := _LEAF.match(text):
        try:
            return AtMost(match[1], match[2], float(match[3]))
        except ValueError as error:
            raise ExpressionError(f"{match[3]!r} is not a number in {text!r}") from error
    wrapped = _WRAPPED.match(text)
    if wrapped is None or depth > _MAX_DEPTH:
        raise ExpressionError(f"expected (<= type.feature number), (not E) or (forall E), found {text[:80]!r}")
    inner = parse_expression(wrapped[2], depth + 1)
    return Not(inner) if wrapped[1] == "not" else ForAll(inner)


def in_words(expression: Expression, called: str = "", *, holds: bool = True) -> str:
    """``fingers of the robot at most 0.5``, or above it unless that ``holds``; ``called`` is said for the type."""
    match expression:
        case Not(inner):
            return in_words(inner, called, holds=not holds)
        case ForAll(inner):
            return ("for every object: " if holds else "not for every object: ") + in_words(inner)
        case AtMost(type_name, feature, bound):
            limit = "at most" if holds else "above"
            return f"{feature.replace('_', ' ')} of the {called or type_name} {limit} {bound:.4g}"
