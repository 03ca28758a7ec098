"""Values of given predicates under which fewer kinds of transitions are needed to explain the demonstrations.

Smoothing along the demonstrations repairs a wrong label that stands between two right ones. At the ends of a
demonstration, and beside a real change, a wrong label looks like an effect that a skill had once. Whether it is one is
a matter of description length (Rissanen 1978): a kind of transition that occurs once, and differs from a common one in
one effect, costs more nats than one wrong label. Kinds of transitions are compared up to renaming objects that are no
arguments of the skill. Values are changed as long as the sum gets smaller, one transition at a time.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from math import log

from pix2pred.learning.operators.robust_settings import KindSettings
from pix2pred.learning.transitions import NOTHING, Extension, IndexedTable, ObjectIds

Place = tuple[int, int, ObjectIds]
"""(predicate, demonstration, objects): a ground atom of a demonstration."""

Change = tuple[int, ObjectIds, bool]
"""(predicate, objects, added rather than deleted)."""

Name = tuple[str, int]
"""An object by its role in a transition: ("", position) of an argument; otherwise type and number, objects about which
more changes first."""

Sign = tuple[int, tuple[Name, ...], bool]
"""A change with objects by their roles."""

Kind = tuple[int, tuple[str, ...], tuple[Sign, ...]]
"""(skill, types of its arguments, changes)."""

Flip = tuple[Place, int, int]
"""The values of an atom in the states from the first number up to, and without, the second."""


def consistent(
    data: IndexedTable, exact: Sequence[int], labelled: IndexedTable, noisy: Sequence[int], settings: KindSettings
) -> dict[int, list[list[Extension]]]:
    """The extensions of the predicates ``noisy``, by demonstration and state.

    ``data`` has the most probable values so far, ``labelled`` the labels; the effects on predicates ``exact`` are
    certain.
    """
    search = _Search(data, exact, labelled, noisy, settings)
    for _ in range(settings.rounds):
        if not search.round():
            break
    return search.extensions()


class _Search:
    """The values, and the kind of every transition under them."""

    def __init__(
        self,
        data: IndexedTable,
        exact: Sequence[int],
        labelled: IndexedTable,
        noisy: Sequence[int],
        settings: KindSettings,
    ) -> None:
        self._data, self._noisy, self._settings = data, frozenset(noisy), settings
        self._values: dict[Place, list[bool]] = {}
        self._labels: dict[Place, list[int]] = {}
        for p in noisy:
            for d, demo in enumerate(data.demos):
                states = range(demo.states)
                atoms = set().union(*(t.extension(d, s, p) for t in (data, labelled) for s in states))
                for args in atoms:
                    self._values[p, d, args] = [args in data.extension(d, s, p) for s in states]
                    self._labels[p, d, args] = [
                        -1 if args in labelled.unknown(d, s, p) else int(args in labelled.extension(d, s, p))
                        for s in states
                    ]
        self._wrong = self._weight_of_a_label()
        self._at = {(tr.demo, tr.step): t for t, tr in enumerate(data.transitions)}
        self._changes: list[set[Change]] = [set() for _ in data.transitions]
        for p in exact:
            for t in data.changing(p):
                for added, changed in zip((True, False), data.effects(p, t), strict=True):
                    self._changes[t].update((p, args, added) for args in changed)
        for (p, d, args), values in self._values.items():
            for s in range(len(values) - 1):
                if values[s] != values[s + 1]:
                    self._changes[self._at[d, s]].add((p, args, values[s + 1]))
        self._kinds = [self._kind(t) for t in range(len(data.transitions))]
        self._count = Counter(self._kinds)
        self._of: dict[tuple[int, tuple[str, ...]], set[Kind]] = {}
        self._variations: dict[tuple[Kind, Kind], float] = {}
        for kind in self._count:
            self._of.setdefault(kind[:2], set()).add(kind)

    def extensions(self) -> dict[int, list[list[Extension]]]:
        found: dict[int, list[list[set[ObjectIds]]]] = {
            p: [[set() for _ in range(demo.states)] for demo in self._data.demos] for p in sorted(self._noisy)
        }
        for (p, d, args), values in self._values.items():
            for s, value in enumerate(values):
                if value:
                    found[p][d][s].add(args)
        return {p: [[frozenset(s) if s else NOTHING for s in d] for d in demos] for p, demos in found.items()}

    def _weight_of_a_label(self) -> float:
        """Nats by which a label speaks for its value, by the share that is wrong so far."""
        labels = wrong = 0
        for place, values in self._values.items():
            for value, label in zip(values, self._labels[place], strict=True):
                labels += label >= 0
                wrong += label == (not value)
        settings = self._settings
        rate = (wrong + settings.imagined_errors) / (labels + settings.imagined_labels)
        return log((1 - rate) / rate)

    def round(self) -> bool:
        """Improve every transition once, rare kinds with many effects first; whether anything changed."""
        changed = False
        order = {t: (self._count[kind], -len(kind[2]), t) for t, kind in enumerate(self._kinds)}
        for t in sorted(order, key=order.__getitem__):
            best = min(((self._gain(flips), flips) for flips in self._moves(t)), default=None, key=lambda m: m[0])
            if best is not None and best[0] < -self._settings.least_gain:
                self._apply(best[1])
                changed = True
        return changed

    def _kind(self, t: int) -> Kind:
        tr = self._data.transitions[t]
        names = self._names(t)
        signs = sorted(_sign(change, names) for change in self._changes[t])
        return tr.skill, tuple(t.name for t in self._data.argument_types(t, ())), tuple(signs)

    def _moves(self, t: int) -> Iterator[tuple[Flip, ...]]:
        """Ways to make a transition one of a kind that is at least as common, or to leave out one of its changes."""
        mine = self._kinds[t]
        if self._count[mine] > self._settings.common:
            return
        for sign in sorted(set(mine[2])):
            yield from ((flip,) for flip in self._removals(t, sign))
        own = Counter(mine[2])
        for kind in sorted(self._of[mine[:2]]):
            if kind == mine or self._count[kind] < self._count[mine]:
                continue
            other = Counter(kind[2])
            surplus, missing = own - other, other - own
            if surplus.total() + missing.total() > self._settings.most_differences:
                continue
            options = [list(self._removals(t, sign)) for sign in surplus.elements()]
            options += [list(self._insertions(t, sign)) for sign in missing.elements()]
            for chosen in product(*options):
                if len({(place, s) for place, s, _ in chosen}) == len(chosen):
                    yield chosen

    def _removals(self, t: int, sign: Sign) -> Iterator[Flip]:
        tr, names = self._data.transitions[t], self._names(t)
        for p, args, added in sorted(self._changes[t]):
            if p in self._noisy and _sign((p, args, added), names) == sign:
                place = (p, tr.demo, args)
                yield self._run_after(place, tr.step + 1)
                yield self._run_before(place, tr.step)

    def _insertions(self, t: int, sign: Sign) -> Iterator[Flip]:
        p, places, added = sign
        if p not in self._noisy:
            return
        tr = self._data.transitions[t]
        names = self._names(t)
        named = {name: o for o, name in names.items()}
        others = [o for o in self._data.demos[tr.demo].objects if o not in names]
        domains = [
            [named[x]] if x in named else [o for o in others if self._data.objects[o].type.name == x[0]] for x in places
        ]
        for args in product(*domains):
            place = (p, tr.demo, args)
            values = self._values.get(place)
            if values is None or len(set(args)) < len(args) or values[tr.step] != values[tr.step + 1]:
                continue
            if values[tr.step] != added:
                yield self._run_after(place, tr.step + 1)
                yield place, tr.step + 1, tr.step + 2
            else:
                yield self._run_before(place, tr.step)
                yield place, tr.step, tr.step + 1

    def _names(self, t: int) -> dict[int, Name]:
        """The roles of the objects that are arguments or change."""
        names: dict[int, Name] = {o: ("", i) for i, o in enumerate(self._data.transitions[t].args)}
        about: dict[int, list[Sign]] = {}
        for p, args, added in self._changes[t]:
            shape = tuple(names.get(o, (self._data.objects[o].type.name, -1)) for o in args)
            for o in args:
                if o not in names:
                    about.setdefault(o, []).append((p, shape, added))
        numbers: Counter[str] = Counter()
        for o in sorted(about, key=lambda o: (-len(about[o]), sorted(about[o]), o)):
            kind = self._data.objects[o].type.name
            names[o] = (kind, numbers[kind])
            numbers[kind] += 1
        return names

    def _run_after(self, place: Place, start: int) -> Flip:
        values = self._values[place]
        stop = start
        while stop < len(values) and values[stop] == values[start]:
            stop += 1
        return place, start, stop

    def _run_before(self, place: Place, last: int) -> Flip:
        values = self._values[place]
        start = last
        while start > 0 and values[start - 1] == values[last]:
            start -= 1
        return place, start, last + 1

    def _gain(self, flips: Sequence[Flip]) -> float:
        """How much longer the description gets, in nats."""
        labels = sum(
            self._wrong * (1 if (self._labels[place][s] == 1) == self._values[place][s] else -1)
            for place, start, stop in flips
            for s in range(start, stop)
            if self._labels[place][s] >= 0
        )
        before = {t: self._kinds[t] for t in self._touched(flips)}
        self._apply(flips)
        after = {t: self._kinds[t] for t in before}
        self._apply(flips)
        return labels + self._description(before, after)

    def _description(self, before: Mapping[int, Kind], after: Mapping[int, Kind]) -> float:
        """How much longer it gets to say of what kind the transitions are and what these kinds do."""
        count = Counter({k: self._count[k] for k in (*before.values(), *after.values())})
        total = 0.0
        for t, old in before.items():
            new = after[t]
            if new == old:
                continue
            count[old] -= 1
            if not count[old]:
                total -= self._settings.kind_cost + self._nearest(old, count)
            if not count[new]:
                total += self._settings.kind_cost + self._nearest(new, count)
            rare = self._settings.imagined
            total -= log((count[new] + rare) / (count[old] + rare))
            count[new] += 1
        return total

    def _nearest(self, kind: Kind, count: Mapping[Kind, int]) -> float:
        """What it costs to say what ``kind`` does, as a variation of another one that occurs."""
        others = (k for k in self._of[kind[:2]] if k != kind and count.get(k, self._count[k]))
        return min((self._variation(kind, other) for other in others), default=self._variation(kind, (*kind[:2], ())))

    def _variation(self, kind: Kind, other: Kind) -> float:
        key = (kind, other)
        if key not in self._variations:
            more, fewer = Counter(kind[2]) - Counter(other[2]), Counter(other[2]) - Counter(kind[2])
            self._variations[key] = sum(map(self._weight, more.elements())) + self._settings.omission * sum(
                map(self._weight, fewer.elements())
            )
        return self._variations[key]

    def _weight(self, sign: Sign) -> float:
        outside = sum(bool(kind) for kind, _ in sign[1])
        return self._settings.effect_cost + self._settings.bystander_cost * outside

    def _touched(self, flips: Sequence[Flip]) -> list[int]:
        found = {(place[1], s) for place, start, stop in flips for s in (start - 1, stop - 1)}
        return sorted(self._at[key] for key in found if key in self._at)

    def _apply(self, flips: Sequence[Flip]) -> None:
        touched = self._touched(flips)
        for place, start, stop in flips:
            values = self._values[place]
            for s in range(start, stop):
                values[s] = not values[s]
            p, d, args = place
            for s in (start - 1, stop - 1):
                if (d, s) in self._at:
                    changes = self._changes[self._at[d, s]]
                    changes -= {(p, args, True), (p, args, False)}
                    if values[s] != values[s + 1]:
                        changes.add((p, args, values[s + 1]))
        for t in touched:
            self._count[self._kinds[t]] -= 1
            self._kinds[t] = kind = self._kind(t)
            self._count[kind] += 1
            self._of[kind[:2]].add(kind)


def _sign(change: Change, names: Mapping[int, Name]) -> Sign:
    p, args, added = change
    return p, tuple(names[o] for o in args), added
