"""Reading conditions, effects and costs; what is not supported is named with its place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from pix2pred.planning.pddl.formulas import (
    TRUE,
    And,
    Effect,
    Equality,
    Formula,
    FunctionValue,
    Literal,
    Or,
    Quantified,
    TypedName,
    negation,
)
from pix2pred.planning.pddl.parts import declared
from pix2pred.planning.pddl.scope import Scope
from pix2pred.planning.pddl.syntax import Group, Node, PddlError, Word, as_group, as_word

_UNSUPPORTED_CONDITIONS = {
    **dict.fromkeys((">", "<", ">=", "<="), "numeric conditions"),
    "preference": "preferences",
    "when": "conditional effects inside conditions",
    **dict.fromkeys(("assign", "increase", "decrease", "scale-up", "scale-down"), "numeric effects in conditions"),
    **dict.fromkeys(("always", "sometime", "within", "at-most-once"), "constraints on trajectories"),
}
_UNSUPPORTED_EFFECTS = {
    **dict.fromkeys(("assign", "decrease", "scale-up", "scale-down"), "numeric effects"),
    **dict.fromkeys(("or", "exists", "imply"), "effects without a definite outcome"),
    **dict.fromkeys(("oneof", "probabilistic"), "effects of chance"),
    "=": "numeric effects",
}
Variables = Mapping[str, TypedName]


class FormulaReader:
    """Reads what stands in conditions and effects, in the names of a scope."""

    def __init__(self, scope: Scope) -> None:
        self._scope = scope
        self._renamed = 0

    def condition(self, node: Node | None, variables: Variables) -> Formula:
        """A condition; none at all is true. Raises ``PddlError``."""
        if node is None:
            return TRUE
        group = as_group(node)
        rest = group.items[1:]
        if not group.items:
            return TRUE
        match group.head:
            case "and":
                return And(tuple(self.condition(item, variables) for item in rest))
            case "or":
                return Or(tuple(self.condition(item, variables) for item in rest))
            case "not":
                return negation(self.condition(self._only(group, "one condition", 1)[0], variables))
            case "imply":
                premise, conclusion = self._only(group, "two conditions", 2)
                return Or((negation(self.condition(premise, variables)), self.condition(conclusion, variables)))
            case "forall" | "exists":
                bound, body = self._quantifier(group, variables)
                inner = self.condition(body, {**variables, **bound})
                return Quantified(group.head == "forall", tuple(bound.values()), inner)
            case "=":
                return self._equality(group, variables)
        if group.head in _UNSUPPORTED_CONDITIONS and group.head not in self._scope.predicates:
            raise PddlError(group.at, f"{_UNSUPPORTED_CONDITIONS[group.head]} ({group.head} ...) are not supported")
        return self.atom(group, variables)

    def atom(self, group: Group, variables: Variables) -> Literal:
        """A predicate applied to terms. Raises ``PddlError``."""
        word = as_word(group.items[0]) if group.items else Word("()", group.at)
        wanted = self._scope.look_up(self._scope.predicates, "predicate", word)
        name = self._scope.original("predicate", word.text)
        return Literal(name, self._scope.arguments(group, name, wanted, variables))

    def effects(self, node: Node | None, variables: Variables) -> Iterator[Effect]:
        """The effects of an action; its costs are left out. Raises ``PddlError``."""
        if node is not None and as_group(node).items:
            yield from self._effects(as_group(node), variables, (), TRUE)

    def _effects(
        self, group: Group, variables: Variables, bound: tuple[TypedName, ...], condition: Formula
    ) -> Iterator[Effect]:
        match group.head:
            case "and":
                for item in group.items[1:]:
                    yield from self._effects(as_group(item), variables, bound, condition)
            case "forall":
                inner, body = self._quantifier(group, variables)
                yield from self._effects(as_group(body), {**variables, **inner}, (*bound, *inner.values()), condition)
            case "when":
                premise, effect = self._only(group, "a condition and an effect", 2)
                both = And((condition, self.condition(premise, variables)))
                yield from self._effects(as_group(effect), variables, bound, both)
            case "not":
                denied = as_group(self._only(group, "one effect", 1)[0])
                yield Effect(bound, condition, _denied(self.atom(denied, variables)))
            case "increase":
                if bound or condition != TRUE:
                    raise PddlError(group.at, "costs that depend on conditions are not supported")
            case head if head in _UNSUPPORTED_EFFECTS:
                raise PddlError(group.at, f"{_UNSUPPORTED_EFFECTS[head]} ({head} ...) are not supported")
            case _:
                yield Effect(bound, condition, self.atom(group, variables))

    def costs(self, node: Node | None, variables: Variables) -> Iterator[int | FunctionValue]:
        """By what an action increases ``(total-cost)``. Raises ``PddlError``."""
        group = as_group(node) if node is not None else None
        if group is None or group.head not in ("and", "increase"):
            return
        if group.head == "and":
            for item in group.items[1:]:
                yield from self.costs(item, variables)
            return
        target, amount = self._only(group, "a function and an amount", 2)
        if as_group(target).head != "total-cost":
            raise PddlError(group.at, "numeric effects (increase ...) on other than (total-cost) are not supported")
        yield self._amount(amount, variables)

    def _amount(self, node: Node, variables: Variables) -> int | FunctionValue:
        if isinstance(node, Word):
            return whole_number(node)
        word = as_word(node.items[0]) if node.items else Word("()", node.at)
        if word.text in ("+", "-", "*", "/"):
            raise PddlError(node.at, "costs are whole numbers or static functions; sums are not supported")
        wanted = self._scope.look_up(self._scope.functions, "function", word)
        return FunctionValue(word.text, self._scope.arguments(node, word.text, wanted, variables))

    def _equality(self, group: Group, variables: Variables) -> Equality:
        left, right = self._only(group, "two terms", 2)
        if isinstance(left, Group) or isinstance(right, Group) or left.text[0].isdigit() or right.text[0].isdigit():
            raise PddlError(group.at, "numeric conditions (= ...) are not supported")
        return Equality(self._scope.term(left, variables).name, self._scope.term(right, variables).name)

    def _quantifier(self, group: Group, variables: Variables) -> tuple[dict[str, TypedName], Node]:
        """The variables by their names in the text, renamed where they hide others, and the body."""
        listed, body = self._only(group, "variables and one condition or effect", 2)
        bound = {}
        for word in declared(as_group(listed).items, "variable"):
            typed = self._scope.typed(word)
            if typed.name in variables:
                self._renamed += 1
                typed = TypedName(f"{typed.name}?{self._renamed}", typed.types)
            bound[word.name.text] = typed
        return bound, body

    @staticmethod
    def _only(group: Group, what: str, count: int) -> Sequence[Node]:
        if len(group.items) != count + 1:
            raise PddlError(group.at, f"({group.head} ...) takes {what}")
        return group.items[1:]


def _denied(literal: Literal) -> Literal:
    return Literal(literal.predicate, literal.terms, positive=False)


def whole_number(word: Word) -> int:
    """The number that ``word`` says. Raises ``PddlError`` unless it is whole and not negative."""
    try:
        value = float(word.text)
    except ValueError:
        raise PddlError(word.at, f"expected a number, found {word.text}") from None
    if not 0 <= value <= 1e15 or value != int(value):
        raise PddlError(word.at, f"costs are whole numbers from 0 to 10^15, found {word.text[:40]}")
    return int(value)
