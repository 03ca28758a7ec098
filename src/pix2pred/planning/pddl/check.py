"""Checking a plan of PDDL step by step, on sets of facts as the language is defined, not on what searches work with."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from pix2pred.planning.pddl.formulas import (
    And,
    Equality,
    Formula,
    FunctionValue,
    Literal,
    Or,
    PddlAction,
    Quantified,
    TypedName,
    conjuncts,
)
from pix2pred.planning.pddl.read import PddlDomain, PddlProblem
from pix2pred.planning.pddl.steps import PddlStep

NamedFact = tuple[str, ...]
"""A predicate and its objects, by name."""

Environment = Mapping[str, str]
"""Objects by variable."""


@dataclass(frozen=True, slots=True)
class CheckedStep:
    """A step of a plan: what was missing before it (``unmet``, in words), what it made true and false, what it cost.

    A step with something unmet changes nothing.
    """

    step: PddlStep
    unmet: tuple[str, ...]
    added: tuple[NamedFact, ...]
    removed: tuple[NamedFact, ...]
    cost: int


@dataclass(frozen=True, slots=True)
class CheckedPlan:
    """The steps of a plan up to the first that cannot be executed, and what of the goal is ``unmet`` after them.

    ``cost`` is the sum over the steps: of what the domain says where it has action costs, else of ones.
    """

    steps: tuple[CheckedStep, ...]
    unmet: tuple[str, ...]
    cost: int

    @property
    def valid(self) -> bool:
        """Whether every step can be executed when its turn comes, and the goal holds at the end."""
        return not self.unmet and not any(step.unmet for step in self.steps)

    def as_dict(self) -> dict[str, object]:
        """The same as a JSON document: facts as ``predicate object ...``."""
        return {
            "valid": self.valid,
            "cost": self.cost,
            "unmet": list(self.unmet),
            "steps": [
                {
                    "step": str(step.step),
                    "unmet": list(step.unmet),
                    "added": [" ".join(fact) for fact in step.added],
                    "removed": [" ".join(fact) for fact in step.removed],
                    "cost": step.cost,
                }
                for step in self.steps
            ],
        }


def check_plan(domain: PddlDomain, problem: PddlProblem, plan: Iterable[PddlStep]) -> CheckedPlan:
    """Execute ``plan`` and say what happens."""
    world = CheckedState(domain, problem)
    facts = {(a.predicate.name, *(o.name for o in a.objects)) for a in problem.initial}
    state = world.derived(facts)
    done: list[CheckedStep] = []
    for step in plan:
        checked, facts = world.execute(step, facts, state)
        state = world.derived(facts)
        done.append(checked)
        if checked.unmet:
            break
    unmet = () if done and done[-1].unmet else tuple(world.unmet(problem.condition, {}, state))
    return CheckedPlan(tuple(done), unmet, sum(s.cost for s in done))


class CheckedState:
    """What never changes in a problem: objects, types, actions and rules. Executes steps and evaluates conditions."""

    def __init__(self, domain: PddlDomain, problem: PddlProblem) -> None:
        self._types = {t.name: t for t in domain.types}
        self._kinds = problem.kinds
        self._actions = {a.name: a for a in domain.actions}
        self._costs = problem.costs
        self._has_costs = any(a.costs for a in domain.actions)
        self._levels = [[r for r in domain.derived if r.head in level] for level in domain.levels]

    def execute(
        self, step: PddlStep, facts: set[NamedFact], state: set[NamedFact]
    ) -> tuple[CheckedStep, set[NamedFact]]:
        """The step with what it changes, and the facts after it: ``facts`` themselves, changed in place."""
        action = self._actions.get(step.action)
        problem = self._misfit(step, action)
        if action is None or problem:
            return CheckedStep(step, (problem,), (), (), 0), facts
        env = {p.name: o for p, o in zip(action.parameters, step.objects, strict=True)}
        unmet = tuple(self.unmet(action.precondition, env, state))
        cost = self._cost(action, env)
        if cost is None:
            unmet = (*unmet, "its cost is not defined for these objects")
        if unmet or cost is None:
            return CheckedStep(step, unmet, (), (), 0), facts
        added: set[NamedFact] = set()
        removed: set[NamedFact] = set()
        for effect in action.effects:
            for chosen in self._choices(effect.variables):
                inner = {**env, **chosen}
                if self.holds(effect.condition, inner, state):
                    fact = (effect.literal.predicate, *(inner.get(t, t) for t in effect.literal.terms))
                    (added if effect.literal.positive else removed).add(fact)
        gained, lost = added - facts, (removed - added) & facts
        facts -= lost
        facts |= gained
        return CheckedStep(step, (), tuple(sorted(gained)), tuple(sorted(lost)), cost), facts

    def _misfit(self, step: PddlStep, action: PddlAction | None) -> str:
        """Why ``step`` is no instance of an action, in words; an empty text when it is one."""
        if action is None:
            return f"there is no action {step.action}"
        if len(step.objects) != len(action.parameters):
            return f"{step.action} takes {len(action.parameters)} objects, found {len(step.objects)}"
        for name, parameter in zip(step.objects, action.parameters, strict=True):
            if name not in self._kinds:
                return f"there is no object {name}"
            if not self._fits(name, parameter):
                return f"{name} is no {' or '.join(parameter.types)}"
        return ""

    def _fits(self, name: str, variable: TypedName) -> bool:
        return any(self._types[kind].is_a(self._types[t]) for kind in self._kinds[name] for t in variable.types)

    def _choices(self, variables: Sequence[TypedName]) -> Iterator[dict[str, str]]:
        members = [[name for name in self._kinds if self._fits(name, v)] for v in variables]
        for chosen in product(*members):
            yield {v.name: name for v, name in zip(variables, chosen, strict=True)}

    def derived(self, facts: set[NamedFact]) -> set[NamedFact]:
        """``facts`` with everything that is derived from them: themselves where nothing can be."""
        if not self._levels:
            return facts
        state = set(facts)
        for rules in self._levels:
            before = -1
            while before != len(state):
                before = len(state)
                for rule in rules:
                    for env in self._choices(rule.parameters):
                        fact = (rule.head, *env.values())
                        if fact not in state and self.holds(rule.body, env, state):
                            state.add(fact)
        return state

    def holds(self, formula: Formula, env: Environment, state: set[NamedFact]) -> bool:
        """Whether ``formula`` is true for the objects of ``env``."""
        match formula:
            case Literal(predicate, terms, positive):
                return ((predicate, *(env.get(t, t) for t in terms)) in state) == positive
            case Equality(left, right, positive):
                return (env.get(left, left) == env.get(right, right)) == positive
            case And(parts):
                return all(self.holds(p, env, state) for p in parts)
            case Or(parts):
                return any(self.holds(p, env, state) for p in parts)
            case Quantified(universal, variables, body):
                cases = (self.holds(body, {**env, **chosen}, state) for chosen in self._choices(variables))
                return all(cases) if universal else any(cases)
        raise AssertionError(f"{formula} is no formula")

    def unmet(self, formula: Formula, env: Environment, state: set[NamedFact]) -> Iterator[str]:
        """The parts of a conjunction that do not hold, in words."""
        for part in conjuncts(formula):
            if not self.holds(part, env, state):
                yield f"{shown(part, env)} does not hold"

    def _cost(self, action: PddlAction, env: Environment) -> int | None:
        if not self._has_costs:
            return 1
        total = 0
        for part in action.costs:
            value: int | None
            if isinstance(part, FunctionValue):
                value = self._costs.get((part.function, tuple(env.get(t, t) for t in part.terms)))
            else:
                value = part
            if value is None:
                return None
            total += value
        return total


def shown(formula: Formula, env: Environment) -> str:
    """``formula`` for the objects of ``env``, as PDDL."""
    match formula:
        case Literal(predicate, terms, positive):
            inner = f"({' '.join((predicate, *(env.get(t, t) for t in terms)))})"
            return inner if positive else f"(not {inner})"
        case Equality(left, right, positive):
            inner = f"(= {env.get(left, left)} {env.get(right, right)})"
            return inner if positive else f"(not {inner})"
        case And(parts):
            return f"({' '.join(('and', *(shown(p, env) for p in parts)))})"
        case Or(parts):
            return f"({' '.join(('or', *(shown(p, env) for p in parts)))})"
        case Quantified(universal, variables, body):
            listed = " ".join(v.name if v.types == ("object",) else f"{v.name} - {_types(v)}" for v in variables)
            return f"({'forall' if universal else 'exists'} ({listed}) {shown(body, env)})"
    raise AssertionError(f"{formula} is no formula")


def _types(variable: TypedName) -> str:
    return variable.types[0] if len(variable.types) == 1 else f"(either {' '.join(variable.types)})"
