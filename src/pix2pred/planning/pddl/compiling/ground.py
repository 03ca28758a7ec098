"""From a PDDL domain and problem to a task on bits.

Actions are instantiated with the facts that are reachable without deletes. What matching with facts does not decide
(negation, equality, quantifiers, disjunctions) is then decided for each instance as far as it does not change, and
split into alternatives where it does: an instance with two alternatives is two operators. Where that would be many, and
for goals with alternatives, a fact is derived that stands for the disjunction.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from pix2pred.planning.grounding import DEFAULT_BUDGET
from pix2pred.planning.instances import Instances
from pix2pred.planning.pddl.compiling.decided import NOTHING_NEEDED, DecidedChanges, Decider, GroundRule
from pix2pred.planning.pddl.compiling.layout import GroundEffect, GroundOperation, operation, task_of
from pix2pred.planning.pddl.compiling.schemas import Numbers, SplitSchema, nothing, split
from pix2pred.planning.pddl.formulas import TRUE, DerivedPredicate, Effect, FunctionValue, Literal, PddlAction
from pix2pred.planning.pddl.read import PddlDomain, PddlProblem
from pix2pred.planning.pddl.steps import PddlStep
from pix2pred.planning.strips import Strips

Bindings = Mapping[int, list[tuple[int, ...]]]
"""Instances of each schema, by its number: objects of its parameters."""


@dataclass(frozen=True, slots=True)
class GroundPddl:
    """A task on bits; ``steps[k]`` is operator k.

    ``goal_reachable`` is False when the goal cannot be reached even without deletes.
    """

    strips: Strips
    steps: tuple[PddlStep, ...]
    goal_reachable: bool


def ground_pddl(domain: PddlDomain, problem: PddlProblem, budget: int = DEFAULT_BUDGET) -> GroundPddl:
    """The task of ``problem``. Raises ``GroundingBudgetError`` when it has more than ``budget`` ground operators."""
    return _PddlGrounder(domain, problem).ground(budget)


@dataclass(frozen=True, slots=True)
class _EffectSplit:
    """An effect with variables or a condition of its own, and the schema that grounds it.

    ``number`` is the place of the schema among all of the task.
    """

    number: int
    split: SplitSchema
    effect: Effect


@dataclass(frozen=True, slots=True)
class _ActionSplit:
    """One alternative of an action: its place among all schemas, its schema, and its effects of both kinds."""

    number: int
    split: SplitSchema
    action: PddlAction
    plain: tuple[Literal, ...]
    special: tuple[_EffectSplit, ...]


class _PddlGrounder:
    def __init__(self, domain: PddlDomain, problem: PddlProblem) -> None:
        self._problem = problem
        self._numbers = Numbers({o.name: problem.kinds[o.name] for o in problem.objects}, domain.types)
        self._splits: list[SplitSchema] = []
        self._actions = [made for action in domain.actions for made in self._action_splits(action)]
        self._rules = [made for rule in domain.derived for made in self._rule_splits(rule)]
        literals = [e.literal for action in domain.actions for e in action.effects]
        self._changes = DecidedChanges(
            changed={a.predicate for a in literals},
            deleted={a.predicate for a in literals if not a.positive},
            derived={rule.head for rule in domain.derived},
        )
        self._given = [a for a in sorted(problem.initial) if a.predicate.name in domain.signatures]

    def ground(self, budget: int) -> GroundPddl:
        """Instantiate, decide what is left over, and lay the facts out as bits."""
        initial = [self._numbers.fact(a.predicate.name, [o.name for o in a.objects]) for a in self._given]
        reached = Instances([s.schema for s in self._splits], initial, budget)
        decider = Decider(self._numbers, reached.facts, frozenset(initial), self._changes)
        bindings: dict[int, list[tuple[int, ...]]] = defaultdict(list)
        for s, binding in sorted(reached.found):
            bindings[s].append(binding)
        operations: dict[tuple[PddlStep, GroundOperation], None] = {}
        for made in self._actions:
            for step, found in self._operations(made, decider, bindings):
                operations[step, found] = None
        rules = [
            GroundRule(body, decider.fact(head, env))
            for number, head in self._rules
            for env in self._environments(number, bindings)
            for body in decider.alternatives(self._splits[number].rest, env)
        ]
        goal = decider.alternatives((self._problem.condition,), {})
        if len(goal) > 1:
            goal = [decider.standing_for(goal)]
        strips = task_of(
            [found for _, found in operations],
            [*rules, *decider.rules],
            frozenset(initial),
            goal[0] if goal else frozenset(),
            use_costs=self._problem.minimise_costs,
            kinds=self._numbers.kinds,
        )
        return GroundPddl(strips, tuple(step for step, _ in operations), bool(goal))

    def _entered(self, made: SplitSchema) -> int:
        self._splits.append(made)
        return len(self._splits) - 1

    def _action_splits(self, action: PddlAction) -> Iterator[_ActionSplit]:
        plain = tuple(e.literal for e in action.effects if not e.variables and e.condition == TRUE)
        for made in split(nothing(action.name), action.parameters, action.precondition, plain, self._numbers):
            number = self._entered(made)
            special = tuple(
                _EffectSplit(self._entered(way), way, effect)
                for effect in action.effects
                if effect.variables or effect.condition != TRUE
                for way in split(made, effect.variables, effect.condition, [effect.literal], self._numbers)
            )
            yield _ActionSplit(number, made, action, plain, special)

    def _rule_splits(self, rule: DerivedPredicate) -> Iterator[tuple[int, Literal]]:
        head = Literal(rule.head, tuple(p.name for p in rule.parameters))
        for made in split(nothing(rule.head), rule.parameters, rule.body, [head], self._numbers):
            yield self._entered(made), head

    def _environments(self, number: int, bindings: Bindings) -> Iterator[dict[str, int]]:
        """Objects by the names of the parameters of a schema, for every instance."""
        for binding in bindings[number]:
            yield dict(zip(self._splits[number].names, binding, strict=True))

    def _operations(
        self, made: _ActionSplit, decider: Decider, bindings: Bindings
    ) -> Iterator[tuple[PddlStep, GroundOperation]]:
        special = self._special_effects(made, decider, bindings)
        names, objects = made.split.names, self._numbers.objects
        plain = [placed for literal in made.plain if (placed := decider.placed(literal, names))]
        assert len(plain) == len(made.plain), "effects have no terms but parameters and constants"
        literals = [placed for part in made.split.rest if (placed := decider.placed(part, names))]
        others = [part for part in made.split.rest if decider.placed(part, names) is None]
        only_positive = not others and all(literal.positive for literal in literals)
        parameters = [names.index(p.name) for p in made.action.parameters]
        for binding in bindings[made.number]:
            env = dict(zip(names, binding, strict=True)) if others or made.action.costs else {}
            cost = self._cost(made.action, env)
            certain = None if cost is None else decider.left_of(literals, binding)
            if cost is None or certain is None:
                continue
            effects = [
                GroundEffect(NOTHING_NEEDED, fact, literal.positive)
                for literal in plain
                if not decider.never_changes(fact := literal.fact(binding))
            ]
            effects += special.get(binding, ())
            step = PddlStep(made.action.name, tuple([objects[binding[i]] for i in parameters]))
            ways = [certain] if only_positive else decider.alternatives(others, env, certain)
            for condition in ways if effects else ():
                found = operation(condition, effects, cost)
                if found is not None:
                    yield step, found

    def _special_effects(
        self, made: _ActionSplit, decider: Decider, bindings: Bindings
    ) -> dict[tuple[int, ...], list[GroundEffect]]:
        """Effects with variables or conditions, by the binding of the action."""
        found: dict[tuple[int, ...], list[GroundEffect]] = defaultdict(list)
        for way in made.special:
            for binding, env in zip(bindings[way.number], self._environments(way.number, bindings), strict=True):
                fact = decider.fact(way.effect.literal, env)
                if decider.never_changes(fact):
                    continue
                for condition in decider.alternatives(way.split.rest, env):
                    effect = GroundEffect(condition, fact, way.effect.literal.positive)
                    found[binding[: len(made.split.names)]].append(effect)
        return found

    def _cost(self, action: PddlAction, env: Mapping[str, int]) -> int | None:
        """What an instance costs; ``None`` when a function has no value for it: it can never be executed."""
        total = 0
        for part in action.costs:
            if isinstance(part, FunctionValue):
                terms = tuple(self._numbers.objects[env[t]] if t in env else t for t in part.terms)
                value = self._problem.costs.get((part.function, terms))
                if value is None:
                    return None
                total += value
            else:
                total += part
        return total
