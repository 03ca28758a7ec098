"""Partitioning transitions by effect, up to renaming objects (method 5.1-5.3).

Unification is an equivalence relation, so joining the first class that unifies gives the equivalence classes, in order
of their first member. A class of a larger predicate set is part of a class of a smaller one: adding a predicate only
re-partitions the classes in which that predicate changes (method 6.5, item 7).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import chain
from typing import NamedTuple

from pix2pred.learning.operators.transition_class import Lifted, Member, MemberCache, Partition, TransitionClass
from pix2pred.learning.transitions import IndexedTable, ObjectIds
from pix2pred.structs import Type

Effect = tuple[int, bool, ObjectIds]
"""(predicate, added rather than deleted, objects)."""


def partition(data: IndexedTable, predicates: Sequence[int]) -> Partition:
    """Partition all transitions over ``predicates``."""
    return _cluster(data, predicates, range(len(data.transitions)))


def refine(data: IndexedTable, classes: Partition, predicates: Sequence[int], added: int) -> Partition:
    """``partition(data, [*predicates, added])``, given the partition over ``predicates``.

    Classes in which ``added`` never changes are kept as they are, identity included.
    """
    changing = data.changing(added)
    refined: list[TransitionClass] = []
    for cls in classes:
        members = [m.transition for m in cls.members]
        if changing.isdisjoint(members):
            refined.append(cls)
        else:
            refined.extend(_split(data, cls, predicates, added))
    return tuple(sorted(refined, key=lambda c: c.first))


class _Change(NamedTuple):
    """What a predicate does in a transition: ``outside`` are the types of objects that the class has no variable for,
    numbered after its variables; ``add`` and ``delete`` are argument tuples in these numbers."""

    outside: tuple[Type, ...]
    add: frozenset[tuple[int, ...]]
    delete: frozenset[tuple[int, ...]]


_NOTHING: frozenset[tuple[int, ...]] = frozenset()
UNCHANGED = _Change((), _NOTHING, _NOTHING)


def _split(data: IndexedTable, cls: TransitionClass, predicates: Sequence[int], added: int) -> Partition:
    """The parts of ``cls`` by what ``added`` does to its variables and to other objects.

    Members whose binding would be one of several, because several other objects of one type change, are clustered from
    scratch: they never unify with the rest. So are all members where several variables of one type are bound by effects
    alone, or where a variable's type is too general for the predicate.
    """
    wider = (*predicates, added)
    free = [t for v, t in enumerate(cls.types) if v not in cls.skill_args]
    if len(set(free)) < len(free):
        return _cluster(data, wider, [m.transition for m in cls.members])
    changing = data.changing(added)
    unchanged: list[tuple[int, Member]] = []
    ambiguous: list[int] = []
    parts: dict[_Change, list[tuple[int, Member]]] = {}
    for i, member in enumerate(cls.members):
        if member.transition not in changing:
            unchanged.append((i, member))
            continue
        found = _change(data, cls, i, added)
        if found is None:
            ambiguous.append(member.transition)
        elif found[0] in parts:
            parts[found[0]].append((i, found[1]))
        elif not all(data.fits(cls.types + found[0].outside, added, atom) for atom in found[0].add | found[0].delete):
            return _cluster(data, wider, [m.transition for m in cls.members])
        else:
            parts[found[0]] = [(i, found[1])]
    if unchanged:
        parts[UNCHANGED] = unchanged
    if len(parts) == 1 and not ambiguous:
        (change,) = parts
        if not change.outside:
            return (
                replace(
                    cls,
                    add=cls.add + tuple((added, v) for v in sorted(change.add)),
                    delete=cls.delete + tuple((added, v) for v in sorted(change.delete)),
                ),
            )
    found_parts = tuple(_part(cls, members, added, change) for change, members in parts.items())
    return found_parts + (_cluster(data, wider, ambiguous) if ambiguous else ())


def _change(data: IndexedTable, cls: TransitionClass, i: int, added: int) -> tuple[_Change, Member] | None:
    """What ``added`` does in the ``i``-th member, and the member with the objects that the class has no variable for.

    ``None`` where several of these are of one type, so that they could be numbered in several ways.
    """
    member, variable = cls.members[i], cls.variables()[i]
    changes = data.effects(added, member.transition)
    others = {o for args in chain(*changes) for o in args if o not in variable}
    kinds: tuple[Type, ...] = ()
    if others:
        ordered = tuple(sorted(others, key=lambda o: data.objects[o].type.name))
        kinds = data.types(ordered)
        if len(set(kinds)) < len(kinds):
            return None
        variable = variable | {o: len(cls.types) + n for n, o in enumerate(ordered)}
        member = Member(member.transition, member.objects + ordered)
    plus, minus = [frozenset([tuple([variable[o] for o in args]) for args in e]) if e else _NOTHING for e in changes]
    return _Change(kinds, plus, minus), member


def _part(cls: TransitionClass, numbered: Sequence[tuple[int, Member]], added: int, change: _Change) -> TransitionClass:
    """The class of some members alone, its variables in the order of the first member's object names."""
    members = tuple([member for _, member in numbered])
    types = cls.types + change.outside
    order = sorted(range(len(types)), key=members[0].objects.__getitem__)
    if order != list(range(len(types))):
        members = tuple([Member(t, tuple([objects[old] for old in order])) for t, objects in members])
    new = {old: v for v, old in enumerate(order)}

    def renumbered(lifted: Iterable[Lifted], more: Iterable[tuple[int, ...]]) -> tuple[Lifted, ...]:
        return tuple(sorted([(p, tuple([new[v] for v in a])) for p, a in (*lifted, *((added, m) for m in more))]))

    return TransitionClass(
        cls.skill,
        tuple(types[old] for old in order),
        tuple(new[v] for v in cls.skill_args),
        renumbered(cls.add, change.add),
        renumbered(cls.delete, change.delete),
        members,
        MemberCache() if change.outside else cls.part([i for i, _ in numbered], order),
    )


def _cluster(data: IndexedTable, predicates: Sequence[int], transitions: Sequence[int]) -> Partition:
    buckets: dict[tuple[object, ...], list[list[Member]]] = defaultdict(list)
    effects = {t: _effects(data, predicates, t) for t in transitions}
    for t in transitions:
        groups = buckets[_invariant(data, t, effects[t])]
        for group in groups:
            objects = _unify(data, group[0], effects[group[0].transition], t, effects[t])
            if objects is not None:
                group.append(Member(t, objects))
                break
        else:
            involved = {o for _, _, objects in effects[t] for o in objects} | {*data.transitions[t].args}
            groups.append([Member(t, tuple(sorted(involved)))])
    classes = [_lift(data, members, effects) for groups in buckets.values() for members in groups]
    return tuple(sorted(classes, key=lambda c: c.first))


def _effects(data: IndexedTable, predicates: Sequence[int], t: int) -> list[Effect]:
    found: list[Effect] = []
    for p in predicates:
        added, deleted = data.effects(p, t)
        if added:
            found += [(p, True, objects) for objects in added]
        if deleted:
            found += [(p, False, objects) for objects in deleted]
    found.sort()
    return found


def _invariant(data: IndexedTable, t: int, effects: Sequence[Effect]) -> tuple[object, ...]:
    """Equal for transitions that unify: arguments by position, other objects by type only."""
    tr = data.transitions[t]
    position: dict[int, object] = {}
    for i, o in enumerate(tr.args):
        position.setdefault(o, i)
    others = sorted({o for _, _, objects in effects for o in objects} - position.keys())
    for o in others:
        position[o] = data.objects[o].type.name
    shape = sorted((p, added, tuple(str(position[o]) for o in objects)) for p, added, objects in effects)
    return (
        tr.skill,
        tuple(position[o] for o in tr.args),
        tuple(t.name for t in data.argument_types(t, [(p, objects) for p, _, objects in effects])),
        tuple(sorted(data.objects[o].type.name for o in others)),
        tuple(shape),
    )


def _unify(data: IndexedTable, first: Member, a: Sequence[Effect], t: int, b: Sequence[Effect]) -> ObjectIds | None:
    """What the variables of ``first`` stand for in transition ``t``: the first bijection in sorted order, if any."""
    target = set(b)
    mapping = dict(zip(data.transitions[first.transition].args, data.transitions[t].args, strict=True))
    free = [o for o in first.objects if o not in mapping]
    rest = sorted({o for _, _, objects in b for o in objects} - set(mapping.values()))
    if len(free) != len(rest):
        return None
    for extended in _assignments(data, mapping, free, rest, a, target):
        return tuple(extended[o] for o in first.objects)
    return None


def _assignments(
    data: IndexedTable,
    mapping: dict[int, int],
    free: list[int],
    rest: list[int],
    a: Sequence[Effect],
    target: set[Effect],
) -> Iterator[dict[int, int]]:
    """Extend ``mapping`` over ``free`` onto ``rest``, types kept, every fully mapped effect found in ``target``."""
    for p, added, objects in a:
        if all(o in mapping for o in objects) and (p, added, tuple(mapping[o] for o in objects)) not in target:
            return
    if not free:
        yield mapping
        return
    head, *tail = free
    for o in rest:
        if data.objects[o].type == data.objects[head].type:
            others = [r for r in rest if r != o]
            yield from _assignments(data, {**mapping, head: o}, tail, others, a, target)


def _lift(data: IndexedTable, members: Sequence[Member], effects: dict[int, list[Effect]]) -> TransitionClass:
    first = members[0]
    number = {o: i for i, o in enumerate(first.objects)}
    lifted = [(p, added, tuple(number[o] for o in objects)) for p, added, objects in effects[first.transition]]
    tr = data.transitions[first.transition]
    about = [(p, objects) for p, _, objects in effects[first.transition]]
    arguments = dict(zip(tr.args, data.argument_types(first.transition, about), strict=True))
    return TransitionClass(
        tr.skill,
        tuple(arguments.get(o, data.objects[o].type) for o in first.objects),
        tuple(number[o] for o in tr.args),
        tuple((p, v) for p, added, v in lifted if added),
        tuple((p, v) for p, added, v in lifted if not added),
        tuple(members),
    )
