"""Section 5 of the method as literally as possible: sets of atoms, bijections by trying all permutations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import permutations

from pix2pred.structs import Action, Atom, LiftedAtom, Object, Operator, TruthTable, Type, Variable

Renaming = dict[Object, Object]


@dataclass(frozen=True)
class Transition:
    action: Action
    before: frozenset[Atom]
    add: frozenset[Atom]
    delete: frozenset[Atom]

    @property
    def objects(self) -> list[Object]:
        return sorted({*self.action.objects, *(o for a in self.add | self.delete for o in a.objects)})


def transitions(table: TruthTable) -> list[Transition]:
    """5.1."""
    found = []
    for demo in table.demos:
        states = demo.abstract_states()
        for before, action, after in zip(states, demo.actions, states[1:], strict=False):
            found.append(Transition(action, before, after - before, before - after))
    return found


def bijections(a: Transition, b: Transition) -> list[Renaming]:
    """5.2: all of them, in sorted order."""
    if a.action.skill != b.action.skill or len(a.objects) != len(b.objects):
        return []
    found = []
    for image in permutations(b.objects):
        m = dict(zip(a.objects, image, strict=True))
        if (
            tuple(m[o] for o in a.action.objects) == b.action.objects
            and all(o.type == m[o].type for o in m)
            and {Atom(x.predicate, tuple(m[o] for o in x.objects)) for x in a.add} == b.add
            and {Atom(x.predicate, tuple(m[o] for o in x.objects)) for x in a.delete} == b.delete
        ):
            found.append(m)
    return found


def naive_operators(
    table: TruthTable, h_pre: float = 0.8, h_data: float = 0.05, strict: bool = False
) -> tuple[Operator, ...]:
    classes: list[list[tuple[Transition, Renaming]]] = []
    for t in transitions(table):
        for members in classes:
            if maps := bijections(members[0][0], t):
                members.append((t, maps[0]))
                break
        else:
            classes.append([(t, {o: o for o in t.objects})])
    operators = []
    for number, members in enumerate(classes):
        first = members[0][0]
        of_skill = sum(len(other) for other in classes if other[0][0].action.skill == first.action.skill)
        if Fraction(len(members), of_skill) >= Fraction(str(h_data)):
            operators.append(_operator(f"Op{number}", members, Fraction(str(h_pre)), strict))
    return tuple(operators)


def _operator(name: str, members: Sequence[tuple[Transition, Renaming]], h: Fraction, strict: bool) -> Operator:
    first = members[0][0]
    variable = {o: Variable(f"?x{i}", o.type) for i, o in enumerate(first.objects)}
    counts: dict[LiftedAtom, int] = {}
    for t, m in members:
        back = {image: variable[o] for o, image in m.items()}
        for atom in t.before:
            if all(o in back for o in atom.objects):
                lifted = LiftedAtom(atom.predicate, tuple(back[o] for o in atom.objects))
                counts[lifted] = counts.get(lifted, 0) + 1
    share = {a: Fraction(c, len(members)) for a, c in counts.items()}
    kept = {a for a, s in share.items() if (s > h if strict and h < 1 else s >= h)}

    def lift(atoms: frozenset[Atom]) -> frozenset[LiftedAtom]:
        return frozenset(LiftedAtom(a.predicate, tuple(variable[o] for o in a.objects)) for a in atoms)

    return Operator(
        name,
        tuple(variable.values()),
        frozenset(kept),
        lift(first.add),
        lift(first.delete),
        first.action.skill,
        tuple(variable[o] for o in first.action.objects),
        len(members),
    )


def canonical(op: Operator, preconditions: bool = True) -> tuple[object, ...]:
    """An operator without its number and up to renaming variables (at most five)."""
    groups = (op.preconditions, op.add, op.delete) if preconditions else (op.add, op.delete)

    def renamed(order: Sequence[int]) -> tuple[object, ...]:
        number = dict(zip(op.parameters, order, strict=True))
        types: list[Type] = [v.type for v in sorted(op.parameters, key=number.__getitem__)]
        shapes = tuple(tuple(sorted((a.predicate.name, *(str(number[v]) for v in a.variables)) for a in g))
                       for g in groups)  # fmt: skip
        return tuple(t.name for t in types), tuple(number[v] for v in op.skill_args), shapes

    best = min((renamed(order) for order in permutations(range(len(op.parameters)))), key=repr)
    return op.skill.name, op.support, best
