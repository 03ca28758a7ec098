"""Actions and derived predicates as schemas for grounding: what can be matched with facts, and what is left over."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from pix2pred.planning.instances import Fact, Schema
from pix2pred.planning.pddl.formulas import And, Equality, Formula, Literal, Or, Quantified, TypedName, substituted
from pix2pred.structs import Type

MAX_ALTERNATIVES = 16
"""Disjuncts into which a condition is split before grounding; what has more is split after it, object by object."""


@dataclass(frozen=True, slots=True)
class SplitSchema:
    """A schema with the names of its parameters, and the conditions that matching with facts does not decide."""

    schema: Schema
    names: tuple[str, ...]
    rest: tuple[Formula, ...]


class Numbers:
    """Objects and predicates as numbers. ``kinds`` are the types of every object, ``types`` all that are declared."""

    def __init__(self, kinds: Mapping[str, tuple[str, ...]], types: Sequence[Type]) -> None:
        self.objects = tuple(kinds)
        self.object = {name: i for i, name in enumerate(kinds)}
        self.kinds = tuple(kinds.values())
        self._types = {t.name: t for t in types}
        self._members: dict[tuple[str, ...], frozenset[int]] = {}
        self._predicates: dict[str, int] = {}

    def predicate(self, name: str) -> int:
        """The number of a predicate."""
        return self._predicates.setdefault(name, len(self._predicates))

    def fact(self, predicate: str, terms: Sequence[str]) -> Fact:
        """The fact that a predicate holds of objects."""
        return (self.predicate(predicate), *(self.object[t] for t in terms))

    def members(self, name: TypedName) -> frozenset[int]:
        """The objects that ``name`` may be."""
        if name.types not in self._members:
            wanted = [self._types[t] for t in name.types]
            self._members[name.types] = frozenset(
                i
                for i, kinds in enumerate(self.kinds)
                if any(self._types[kind].is_a(t) for kind in kinds for t in wanted)
            )
        return self._members[name.types]


def nothing(name: str) -> SplitSchema:
    """What the schemas of the action or derived predicate ``name`` begin with."""
    return SplitSchema(Schema((), (), (), (), name), (), ())


def split(
    base: SplitSchema, variables: Sequence[TypedName], condition: Formula, effect: Sequence[Literal], numbers: Numbers
) -> Iterator[SplitSchema]:
    """Schemas that together cover what ``base`` does, ``variables`` for which ``condition`` holds as well.

    There is one for each of a few disjuncts. Their parameters are those of ``base``, ``variables``, variables of
    existential quantifiers, and constants. The positive literals of ``effect`` are what becomes true.
    """
    for found, parts in _alternatives(condition, ""):
        literals = [p for p in parts if isinstance(p, Literal) and p.positive]
        new = (*variables, *found)
        known = {*base.names, *(v.name for v in new)}
        constants = sorted({t for a in (*literals, *effect) for t in a.terms} - known)
        names = (*base.names, *(v.name for v in new), *constants)
        position = {name: i for i, name in enumerate(names)}
        allowed = [numbers.members(v) for v in new] + [frozenset((numbers.object[c],)) for c in constants]
        apart = [set(others) for others in base.schema.apart] + [set() for _ in allowed]
        for part in parts:
            if isinstance(part, Equality) and not part.positive and {part.left, part.right} <= set(names):
                one, other = position[part.left], position[part.right]
                apart[one].add(other)
                apart[other].add(one)

        def lifted(atoms: Sequence[Literal], position: Mapping[str, int] = position) -> tuple[Fact, ...]:
            return tuple((numbers.predicate(a.predicate), *(position[t] for t in a.terms)) for a in atoms)

        schema = Schema(
            [*base.schema.allowed, *allowed],
            tuple(dict.fromkeys((*base.schema.pre, *lifted(literals)))),
            lifted([a for a in effect if a.positive]),
            [tuple(sorted(others)) for others in apart],
            base.schema.name,
        )
        yield SplitSchema(schema, names, tuple(parts))


def _alternatives(formula: Formula, path: str) -> list[tuple[tuple[TypedName, ...], list[Formula]]]:
    """Conjunctions of which one must hold, each with the variables of which some choice must do.

    ``path`` tells the place of ``formula`` in the whole condition; it keeps variables of different quantifiers apart.
    """
    match formula:
        case And(parts):
            choices = []
            count = 1
            for i, part in enumerate(parts):
                choice = _alternatives(part, f"{path}.{i}")
                if count * len(choice) > MAX_ALTERNATIVES:
                    choice = [((), [part])]
                count *= len(choice)
                choices.append(choice)
            return [
                (tuple(v for variables, _ in chosen for v in variables), [f for _, fs in chosen for f in fs])
                for chosen in product(*choices)
            ]
        case Or(parts):
            found = [way for i, part in enumerate(parts) for way in _alternatives(part, f"{path}.{i}")]
            return found if len(found) <= MAX_ALTERNATIVES else [((), [formula])]
        case Quantified(universal=False, variables=variables, body=body):
            renamed = tuple(TypedName(f"{v.name}{path}", v.types) for v in variables)
            inner = substituted(body, {v.name: r.name for v, r in zip(variables, renamed, strict=True)})
            return [((*renamed, *more), parts) for more, parts in _alternatives(inner, path)]
    return [((), [formula])]
