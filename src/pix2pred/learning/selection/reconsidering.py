"""Second thoughts of a climb: pairs of predicates where none helps alone, and better sets near the one it reached."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pix2pred.learning.selection.result import ClimbStep
from pix2pred.learning.selection.scored_sets import ScoredSets
from pix2pred.learning.selection.stopping_rule import Reconsidering, ScoredSet
from pix2pred.system.progress import Progress


class Reconsideration:
    """What a rule that reconsiders makes of a climb over ``sets``."""

    def __init__(self, rule: Reconsidering, sets: ScoredSets) -> None:
        self._rule, self._sets = rule, sets

    def pair(
        self, reached: ScoredSet, singly: Sequence[ScoredSet], progress: Progress
    ) -> Sequence[tuple[ScoredSet, ClimbStep]] | None:
        """Two candidates that pay only together, neither of which is the best by itself, if there are any.

        Behind each promising first one all second ones are looked at; then the first is chosen again, given the second.
        """
        seconds: list[ScoredSet] = []
        for first in self._rule.firsts(self._sets.model, reached, [s for s in singly if s.score.exact]):
            seconds += self._sets.worthwhile(reached, self._sets.expand(first, progress))
        if not seconds:
            return None
        p = min(seconds, key=lambda s: s.score.total).predicate
        second = next(s for s in singly if s.predicate == p)
        second = self._sets.set_of(second.chosen)
        scored = self._sets.expand(second, progress)
        first = self._rule.choose(self._sets.model, self._sets.worthwhile(reached, scored))
        return (second, self._sets.step(second, singly)), (first, self._sets.step(first, scored))

    def better(
        self, reached: ScoredSet, singly: Sequence[ScoredSet], progress: Progress
    ) -> Iterator[tuple[ScoredSet, ClimbStep | None]]:
        """Sets near the reached one, each better than the one before; ``singly`` are those of one candidate more."""
        for p in self._rule.doubtful(self._sets.model, self._sets.added(reached)):
            exchanged = self._exchanged(reached, p, progress)
            if exchanged is not None:
                reached, singly = exchanged[0], ()
                yield exchanged
        one_for_many = self._one_for_many(reached, singly or self._sets.expand(reached, progress))
        if one_for_many is not None:
            reached = one_for_many[0]
            yield one_for_many
        reached = self._sets.set_of(self._sets.without_superseded(reached))
        yield reached, None
        contrary = self._contrary(reached)
        while contrary is not None:
            yield contrary
            contrary = self._contrary(contrary[0])

    def _exchanged(self, reached: ScoredSet, doubtful: int, progress: Progress) -> tuple[ScoredSet, ClimbStep] | None:
        """The reached set with another predicate in the place of a doubtful one, if the rule prefers it."""
        scored = self._sets.expand(self._sets.set_of([p for p in reached.chosen if p != doubtful]), progress)
        rivals = [s for s in scored if s.score.exact and self._rule.replaces(self._sets.model, s, reached, doubtful)]
        if not rivals:
            return None
        best = self._rule.choose(self._sets.model, rivals)
        return best, self._sets.step(best, scored)

    def _one_for_many(self, reached: ScoredSet, singly: Sequence[ScoredSet]) -> tuple[ScoredSet, ClimbStep] | None:
        """The best smaller set: with one more predicate, without at least two that this one makes superfluous.

        Greedy choice can end with two words that together stand in for one: "not on the floor" and "scribbled on" for
        "on the table".
        """
        better = [
            s
            for s in singly
            if s.score.exact
            and s.score.total < reached.score.total
            and self._rule.stands_for_several(self._sets.model, s.predicate)
        ]
        smaller = [(s, self._sets.set_of(self._sets.without_superseded(s))) for s in better]
        found = [
            (s, fewer)
            for s, fewer in smaller
            if len(fewer.chosen) < len(reached.chosen) and fewer.score.total <= reached.score.total
        ]
        if not found:
            return None
        added, best = min(found, key=lambda pair: (len(pair[1].chosen), pair[1].score.total))
        return best, self._sets.step(added, singly)

    def _contrary(self, reached: ScoredSet) -> tuple[ScoredSet, ClimbStep] | None:
        """The reached set with the contrary of one of its predicates, if a skill needs that this one does not hold."""
        wanted = self._rule.contraries(
            self._sets.model, reached, [p for p in self._sets.representatives if p not in reached.chosen]
        )
        scored = [
            s
            for s in (self._sets.set_of((*reached.chosen, p)) for p in wanted)
            if self._rule.negates(self._sets.model, reached, s)
        ]
        if not scored:
            return None
        best = min(scored, key=lambda s: s.score.total)
        return best, self._sets.step(best, scored)
