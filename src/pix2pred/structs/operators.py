"""Lifted operators and their structural laws (method 1.6)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from pix2pred.structs.objects import Object, Variable, groundings
from pix2pred.structs.predicates import Atom, LiftedAtom
from pix2pred.structs.skills import Action, Skill
from pix2pred.structs.states import AbstractState


@dataclass(frozen=True, slots=True)
class Operator:
    """``<name, parameters, preconditions, add effects, delete effects, skill(arguments)>``.

    Distinct parameters stand for distinct objects. ``support`` counts the transitions it was learned from.
    """

    name: str
    parameters: tuple[Variable, ...]
    preconditions: frozenset[LiftedAtom]
    add: frozenset[LiftedAtom]
    delete: frozenset[LiftedAtom]
    skill: Skill
    skill_args: tuple[Variable, ...]
    support: int = 0

    def ground(self, objects: tuple[Object, ...]) -> GroundOperator:
        """Bind the parameters, in order, to ``objects``."""
        binding = dict(zip(self.parameters, objects, strict=True))
        return GroundOperator(
            self,
            objects,
            frozenset(a.ground(binding) for a in self.preconditions),
            frozenset(a.ground(binding) for a in self.add),
            frozenset(a.ground(binding) for a in self.delete),
            tuple(binding[v] for v in self.skill_args),
        )

    def groundings(self, fixed: Mapping[Variable, Object], objects: Iterable[Object]) -> Iterator[GroundOperator]:
        """Every way to bind the parameters, in sorted order: those in ``fixed`` as given, the others to ``objects``.

        All are distinct and of their types; there is no way when those in ``fixed`` are not.
        """
        if len(set(fixed.values())) < len(fixed) or not all(o.type.is_a(v.type) for v, o in fixed.items()):
            return
        free = [v for v in self.parameters if v not in fixed]
        for chosen in groundings([v.type for v in free], set(objects) - set(fixed.values()), distinct=True):
            binding = {**fixed, **dict(zip(free, chosen, strict=True))}
            yield self.ground(tuple(binding[v] for v in self.parameters))

    def broken_laws(self) -> Iterator[str]:
        """Which of the structural laws of method 1.6 this operator breaks, one sentence each."""
        effects = self.add | self.delete
        used = {v for atom in effects for v in atom.variables} | set(self.skill_args)
        if used != set(self.parameters) or len(set(self.parameters)) != len(self.parameters):
            yield f"{self.name}: parameters are not exactly the variables of effects and skill arguments"
        if self.add & self.delete:
            yield f"{self.name}: an atom is both added and deleted"
        if self.add & self.preconditions:
            yield f"{self.name}: an added atom is also a precondition"
        if not self.delete <= self.preconditions:
            yield f"{self.name}: a deleted atom is not a precondition"
        if any(set(a.variables) - set(self.parameters) for a in self.preconditions):
            yield f"{self.name}: a precondition mentions a variable that is no parameter"

    def __str__(self) -> str:
        def atoms(group: frozenset[LiftedAtom]) -> str:
            return ", ".join(str(a) for a in sorted(group)) or "-"

        return (
            f"{self.name}({', '.join(f'{v.name}:{v.type.name}' for v in self.parameters)})"
            f"  {self.skill.name}({', '.join(v.name for v in self.skill_args)})\n"
            f"  pre {atoms(self.preconditions)}\n  add {atoms(self.add)}\n  del {atoms(self.delete)}"
        )


@dataclass(frozen=True, slots=True)
class GroundOperator:
    """An operator with its parameters bound to objects."""

    operator: Operator
    objects: tuple[Object, ...]
    preconditions: frozenset[Atom]
    add: frozenset[Atom]
    delete: frozenset[Atom]
    skill_objects: tuple[Object, ...]

    @property
    def action(self) -> Action:
        """The skill that it runs, without continuous parameters."""
        return Action(self.operator.skill, self.skill_objects)

    def applicable(self, state: AbstractState) -> bool:
        """Whether every precondition holds in ``state``."""
        return self.preconditions <= state

    def apply(self, state: AbstractState) -> AbstractState:
        """The successor: deletes first, then adds."""
        return (state - self.delete) | self.add

    def __str__(self) -> str:
        return f"{self.operator.name}({', '.join(o.name for o in self.objects)})"
