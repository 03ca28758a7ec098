"""Predicates over features as one says them."""

from __future__ import annotations

from pix2pred.structs import FromFeatures, Predicate
from pix2pred.structs.expressions import AtMost, Expression, ForAll, Not, parse_expression


def meaning(predicate: Predicate) -> str:
    """``fingers of a robot at most 0.5``; empty for a predicate that is not computed from features."""
    source = predicate.source
    return _said(parse_expression(source.expression), holds=True) if isinstance(source, FromFeatures) else ""


def _said(expression: Expression, *, holds: bool) -> str:
    match expression:
        case Not(inner):
            return _said(inner, holds=not holds)
        case ForAll(inner):
            return ("for every object: " if holds else "not for every object: ") + _said(inner, holds=True)
        case AtMost(type_name, feature, bound):
            return f"{feature.replace('_', ' ')} of the {type_name} {'at most' if holds else 'above'} {bound:.4g}"
