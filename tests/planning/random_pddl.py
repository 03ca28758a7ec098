"""Small random problems with all of the PDDL that is read, and breadth-first search over all tuples of objects."""

from __future__ import annotations

from itertools import product
from random import Random

from pix2pred.planning.pddl.check import CheckedState
from pix2pred.planning.pddl.read import PddlDomain, PddlProblem
from pix2pred.planning.pddl.steps import PddlStep

ARITY = {"done": 0, "lit": 1, "at": 2}
KINDS = ("thing", "ball", "(either ball box)", "object")


def random_texts(seed: int) -> tuple[str, str]:
    """A domain and a problem. Derived predicates use what is changed, and one is derived from the other's negation."""
    rng = Random(seed)
    actions = "\n".join(_action(rng, i) for i in range(rng.randint(1, 3)))
    derived = ""
    if rng.random() < 0.5:
        derived = f"(:derived (near ?u - thing) {_condition(rng, ['?u'], 2, basic=True)})\n"
        derived += "(:derived (near ?u - thing) (exists (?w - thing) (and (at ?w ?u) (near ?w))))\n"
        derived += "(:derived (far ?u - thing) (not (near ?u)))\n"
    domain = f"""(define (domain d) (:requirements :adl)
(:types ball box - thing) (:constants home - ball)
(:predicates (done) (lit ?x - thing) (at ?x - thing ?y - thing) (near ?x - thing) (far ?x - thing))
(:functions (total-cost) - number (price ?x - thing) - number)
{derived}{actions})"""
    objects = [f"o{i}" for i in range(rng.randint(0, 2))]
    names = ["home", *objects]
    facts = [f"({' '.join((p, *args))})" for p, n in ARITY.items() for args in product(names, repeat=n)]
    initial = " ".join(f for f in facts if rng.random() < 0.3)
    prices = " ".join(f"(= (price {n}) {rng.randint(0, 3)})" for n in names if rng.random() < 0.9)
    goal = _condition(rng, [], 2, basic=not derived)
    things = " ".join(f"{o} - {rng.choice(('ball', 'box', 'thing'))}" for o in objects)
    metric = "(:metric minimize (total-cost))" if rng.random() < 0.5 else ""
    return domain, (
        f"(define (problem p) (:domain d) (:objects {things}) (:init {initial} {prices})\n(:goal {goal}) {metric})"
    )


def _action(rng: Random, number: int) -> str:
    variables = [f"?v{i}" for i in range(rng.randint(0, 2))]
    listed = " ".join(f"{v} - {rng.choice(KINDS)}" for v in variables)
    effects = " ".join(_effect(rng, variables, 1) for _ in range(rng.randint(1, 3)))
    if rng.random() < 0.7:
        effects += f" (increase (total-cost) {rng.choice(['1', '2', f'(price {_term(rng, variables)})'])})"
    before = _condition(rng, variables, 2, basic=rng.random() < 0.5)
    return f"(:action a{number} :parameters ({listed}) :precondition {before} :effect (and {effects}))"


def _effect(rng: Random, variables: list[str], depth: int) -> str:
    kind = rng.random()
    if depth and kind < 0.25:
        return f"(when {_condition(rng, variables, 1, basic=True)} {_effect(rng, variables, 0)})"
    if depth and kind < 0.4:
        inner = [*variables, "?all"]
        return f"(forall (?all - thing) (when {_atom(rng, inner, basic=True)} {_effect(rng, inner, 0)}))"
    atom = _atom(rng, variables, basic=True)
    return atom if rng.random() < 0.6 else f"(not {atom})"


def _condition(rng: Random, variables: list[str], depth: int, *, basic: bool) -> str:
    kind = rng.random()
    if not depth or kind < 0.3:
        atom = _atom(rng, variables, basic=basic)
        return atom if rng.random() < 0.7 else f"(not {atom})"
    if kind < 0.7:
        parts = " ".join(_condition(rng, variables, depth - 1, basic=basic) for _ in range(rng.randint(0, 2)))
        return f"({rng.choice(('and', 'and', 'or') if parts else ('and',))} {parts})"
    if kind < 0.8:
        one, other = (_condition(rng, variables, depth - 1, basic=basic) for _ in range(2))
        return f"(imply {one} {other})"
    if kind < 0.9:
        name = rng.choice(("?q", "?v0"))
        body = _condition(rng, [*variables, name], depth - 1, basic=basic)
        return f"({rng.choice(('forall', 'exists'))} ({name} - {rng.choice(KINDS[:3])}) {body})"
    return f"(= {_term(rng, variables)} {_term(rng, variables)})"


def _atom(rng: Random, variables: list[str], *, basic: bool) -> str:
    predicate = rng.choice(list(ARITY) if basic else ["near", "far", *ARITY])
    terms = [_term(rng, variables) for _ in range(ARITY.get(predicate, 1))]
    return f"({' '.join((predicate, *terms))})"


def _term(rng: Random, variables: list[str]) -> str:
    return rng.choice([*variables, *variables, "home"])


def cheapest(domain: PddlDomain, problem: PddlProblem, limit: int = 400) -> int | None:
    """What the cheapest plan costs (with costs that are to be minimised), or how long the shortest is.

    ``None`` when there is none, -1 when there are more than ``limit`` states.
    """
    world = CheckedState(domain, problem)
    names = [o.name for o in problem.objects]
    steps = [PddlStep(a.name, args) for a in domain.actions for args in product(names, repeat=len(a.parameters))]
    start = frozenset((a.predicate.name, *(o.name for o in a.objects)) for a in problem.initial)
    best = {start: 0}
    open_states = [(0, 0, start)]
    closed = set()
    while open_states:
        open_states.sort(key=lambda entry: entry[:2])
        cost, _, facts = open_states.pop(0)
        if facts in closed:
            continue
        closed.add(facts)
        state = world.derived(set(facts))
        if world.holds(problem.condition, {}, state):
            return cost
        if len(best) > limit:
            return -1
        for step in steps:
            checked, after = world.execute(step, set(facts), state)
            reached = cost + (checked.cost if problem.minimise_costs else 1)
            if not checked.unmet and reached < best.get(frozenset(after), 10**9):
                best[frozenset(after)] = reached
                open_states.append((reached, len(best), frozenset(after)))
    return None
