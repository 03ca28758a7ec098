"""Which role the objects of an atom have in a transition: which of the transition's variables stand for them.

What a skill does to an atom is learned per role. The variables of a transition's class are the arguments of its skill
and the objects of its given effects. A skill may also change an object that is neither: turning the machine on fills
the jug. Such an object, a bystander, can be named where every demonstration has only one object of its type.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Self

import numpy as np
from numpy.typing import NDArray

from pix2pred.learning.operators.robust_settings import RoleSettings
from pix2pred.learning.operators.transition_class import Partition
from pix2pred.learning.transitions import IndexedTable, ObjectIds
from pix2pred.structs import Type

Role = tuple[int, tuple[int, ...]]
"""(number of a class, variables of that class, in the order of the atom's arguments)."""


@dataclass(frozen=True, slots=True)
class Bystanders:
    """Types of which every demonstration has exactly one object, and these objects by demonstration."""

    types: tuple[Type, ...]
    objects: tuple[ObjectIds, ...]

    @classmethod
    def of(cls, data: IndexedTable) -> Self:
        """Those of all demonstrations."""
        counts = [Counter(data.types(demo.objects)) for demo in data.demos]
        known = {t for count in counts for t in count}
        types = tuple(sorted((t for t in known if all(c[t] == 1 for c in counts)), key=lambda t: t.name))
        places = [{data.objects[o].type: o for o in demo.objects} for demo in data.demos]
        return cls(types, tuple(tuple(by_type[t] for t in types) for by_type in places))


class Roles:
    """Numbers the roles of atoms in transitions.

    0 means that there is no transition, 1 that an object of the atom is not among the transition's variables; from 2 on
    there is a number for every (class, variables), and ``keys`` tells which. Variable ``n + i`` of a class with ``n``
    variables is the ``i``-th bystander. An atom about a bystander has a role of its own only for a predicate whose
    labels show a change there nearly every time.
    """

    OUTSIDE = 1
    LINKED, UNLINKED = -1, -2
    """In place of a variable, for an object that is none: linked to one by an atom, or not."""

    def __init__(
        self,
        data: IndexedTable,
        classes: Partition,
        bystanders: Bystanders,
        noisy: Sequence[int],
        settings: RoleSettings,
        beyond: bool = False,
    ) -> None:
        self._data = data
        self._settings = settings
        self.keys: list[Role] = [(-1, ()), (-1, ())]
        self._numbers: dict[Role, int] = {}
        self._classes = classes
        self._bound: list[list[tuple[int, dict[int, int]]]] = [[] for _ in data.demos]
        member_of = {m.transition: (c, m) for c, cls in enumerate(classes) for m in cls.members}
        for t, tr in enumerate(data.transitions):
            c, member = member_of[t]
            beside = {o: len(member.objects) + i for i, o in enumerate(bystanders.objects[tr.demo])}
            self._bound[tr.demo].append((c, beside | {o: v for v, o in enumerate(member.objects)}))
        self._rows: dict[tuple[int, ObjectIds, int], list[int]] = {}
        self._touched: dict[tuple[int, object], set[ObjectIds]] = {}
        seen = {p: self._seen_to_change(p) for p in noisy} if bystanders.types else {}
        self._seen = {p: roles for p, roles in seen.items() if roles}
        self._linked = self._links(noisy) if beyond else None

    def touched(self, demo: int, predicate: int) -> set[ObjectIds]:
        """Argument tuples of ``predicate`` that some transition of the demonstration has among its variables."""
        types = self._data.predicates[predicate].types
        key = (demo, types)
        if key not in self._touched:
            found: set[ObjectIds] = set()
            for c, number in self._bound[demo]:
                own = [o for o, v in number.items() if not self._beside(c, v)]
                domains = [[o for o in own if self._data.objects[o].type.is_a(t)] for t in types]
                found.update(args for args in product(*domains) if len(set(args)) == len(args))
            self._touched[key] = found
        return self._touched[key]

    def row(self, demo: int, args: ObjectIds, predicate: int) -> list[int]:
        """The number of an atom's role in every transition of a demonstration."""
        beside = self._seen.get(predicate, set())
        key = (demo, args, predicate if beside else -1)
        if key not in self._rows:
            self._rows[key] = [self._number(demo, t, args, beside) for t in range(len(self._bound[demo]))]
        return self._rows[key]

    def beyond(self) -> NDArray[np.bool_]:
        """Which roles are about objects that are no variables of their class."""
        return np.array([any(v < 0 for v in variables) for _, variables in self.keys])

    def siblings(self) -> NDArray[np.int64]:
        """A number per role, equal for roles that are the same arguments of the same skill, whatever the class.

        Roles that involve more than arguments of the skill are alone in their group.
        """
        groups: dict[object, int] = {}
        result = []
        for role, (c, variables) in enumerate(self.keys):
            args = self._classes[c].skill_args if c >= 0 else ()
            shared = c >= 0 and all(v in args or v < 0 for v in variables)
            key: object = (
                (self._classes[c].skill, *(args.index(v) if v >= 0 else v for v in variables)) if shared else (role,)
            )
            result.append(groups.setdefault(("skill", key) if shared else key, len(groups)))
        return np.array(result, dtype=np.int64)

    def _number(self, demo: int, t: int, args: ObjectIds, beside: set[Role]) -> int:
        c, number = self._bound[demo][t]
        linked = self._linked[demo][t] if self._linked else set()
        key = (c, tuple(number.get(o, self.LINKED if o in linked else self.UNLINKED) for o in args))
        if self._linked is None and min(key[1], default=0) < 0:
            return self.OUTSIDE
        if any(self._beside(c, v) for v in key[1]) and key not in beside:
            return self.OUTSIDE
        if key not in self._numbers:
            self._numbers[key] = len(self.keys)
            self.keys.append(key)
        return self._numbers[key]

    def _links(self, predicates: Sequence[int]) -> list[list[set[int]]]:
        """For every transition the objects of which an atom, before or after it, says something together with one of
        its variables."""
        found: list[list[set[int]]] = []
        for d, bound in enumerate(self._bound):
            found.append([])
            for t, (_, number) in enumerate(bound):
                atoms = (args for p in predicates for s in (t, t + 1) for args in self._data.extension(d, s, p))
                found[-1].append({o for args in atoms if not number.keys().isdisjoint(args) for o in args})
        return found

    def _beside(self, c: int, variable: int) -> bool:
        return variable >= len(self._classes[c].types)

    def _seen_to_change(self, predicate: int) -> set[Role]:
        """Roles about bystanders where the labels of a predicate change in the same way nearly every time."""
        bound = [(number, c) for of_demo in self._bound for c, number in of_demo]  # in order of transitions
        changes: Counter[tuple[Role, bool]] = Counter()
        for t in self._data.changing(predicate):
            number, c = bound[t]
            for added, extension in zip((True, False), self._data.effects(predicate, t), strict=True):
                for args in extension:
                    variables = tuple(number.get(o, -1) for o in args)
                    if -1 not in variables and any(self._beside(c, v) for v in variables):
                        changes[(c, variables), added] += 1
        return {
            role
            for (role, _), count in changes.items()
            if count >= max(self._settings.least_changes, self._settings.least_share * self._members(role))
        }

    def _members(self, role: Role) -> int:
        return len(self._classes[role[0]].members)
