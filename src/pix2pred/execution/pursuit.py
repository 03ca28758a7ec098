"""Following a plan: which step comes next, when to look again, and when to plan again (method 8.5).

A surprise is first checked and then believed: before the plan is made anew, or given up, the atoms that are the reason
are asked about again, as far as their values are in doubt. When no plan is found, the plan of the nearest state that
has one is looked for, and what it rests on is asked about; at last, where nobody minds, it is tried.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum, StrEnum, auto
from typing import Protocol

from pix2pred.execution.belief.perception import Perception
from pix2pred.execution.doubtful import NearestPlan, nearest_plan, safer_plan, simpler, unsure
from pix2pred.execution.monitor import necessary_atoms
from pix2pred.structs import (
    AbstractState,
    Action,
    Atom,
    FromVLM,
    GroundOperator,
    PlanResult,
    PlanStatus,
    Turn,
    WhyAsked,
)

MAX_REPLANS = 30
"""Plans made after the first; an episode that needs more goes in circles."""

MOST_TRIES = 3
"""Times a skill may fail in states that look the same: with labels that are wrong now and then, once proves little."""

MOST_DRAWS = 10
"""The same for a skill with parameters, which are drawn anew each time."""

MOST_WAYS = 3
"""Actions that may fail so often in one and the same state, each when the ones before it are avoided; if three do not
work where the learned operators say they do, more will not."""

MOST_CAUTIONS = 2
"""Times that the plan avoids to rest on one and the same atom: what stays in doubt then has to be relied on."""

MOST_NAMED = 3
"""Atoms named in a reason."""


class Licence(Enum):
    """What a plan may use: what was learned; the same about kinds of objects that no demonstration showed; or an action
    that failed again and again, once something about its objects has changed."""

    LEARNED = auto()
    BY_ANALOGY = auto()
    AFTER_A_CHANGE = auto()


class PlanFrom(Protocol):
    """Makes a plan from a state, one without the actions ``avoided``."""

    def __call__(
        self, seen: AbstractState, /, avoided: Collection[Action] = (), licence: Licence = Licence.LEARNED
    ) -> PlanResult: ...


LICENCES: Mapping[Licence, Turn] = {
    Licence.AFTER_A_CHANGE: Turn.OTHERWISE,
    Licence.BY_ANALOGY: Turn.BY_ANALOGY,
}
"""In which order they are tried, and what is said of it: what fails again and again lacks something that was not
learned."""

UNLIKELY: Mapping[Licence, float] = {Licence.LEARNED: 0.0, Licence.BY_ANALOGY: 1.0, Licence.AFTER_A_CHANGE: 3.0}
"""Nats against such a plan, to be compared with those against atoms that would have to hold: what a skill does to one
thing it mostly does to another; that a change helps, whatever it is, is a guess."""


class GivingUp(StrEnum):
    """Why nothing more is tried."""

    REPLANS = "too many plans"
    NO_PLAN = "no plan any more"
    STUCK = "a skill fails again and again"


class GivenUpError(RuntimeError):
    """There is nothing left to try; ``why`` in words for people, ``kind`` for programs.

    ``suspects`` holds the least sure of the atoms that the skills need which failed again and again: it may always be
    misread.
    """

    def __init__(self, kind: GivingUp, why: str, suspects: tuple[Atom, ...] = ()) -> None:
        super().__init__(why)
        self.kind = kind
        self.suspects = suspects


MayAssume = Callable[[Sequence[Atom]], bool]
"""Whether a plan that rests on these atoms may be tried although they look as if they did not hold."""


def assume_nothing(atoms: Sequence[Atom]) -> bool:
    """Give up instead."""
    return False


def assume_all(atoms: Sequence[Atom]) -> bool:
    """Try it: who watches can stop before every skill."""
    return True


@dataclass(slots=True)
class Pursuit:
    """A plan being followed; made anew when the atoms that its rest needs do not hold in what is believed.

    ``position`` is the number of its steps executed, ``replans`` how often it was made anew. ``turn`` and ``because``
    say why the step that ``next`` gave last was chosen. ``may_assume`` decides whether a plan is tried that rests on
    atoms which probably do not hold, when there is no other; who is ``resourceful`` tries what was not learned as well,
    and does not leave a task whose goal may not hold. Of ``goals``, which are as good, the first is that of
    ``plan``; a new plan may be for another.
    """

    plan_from: PlanFrom
    goals: Sequence[Sequence[Atom]]
    plan: Sequence[GroundOperator]
    perception: Perception
    max_replans: int = MAX_REPLANS
    may_assume: MayAssume = assume_nothing
    resourceful: bool = False
    position: int = 0
    replans: int = 0
    turn: Turn = Turn.FOLLOWED
    because: tuple[Atom, ...] = ()
    _goal: Sequence[Atom] | None = None
    _assumed: frozenset[Atom] = frozenset()
    _cautions: Counter[Atom] = field(default_factory=Counter)
    _failures: Counter[tuple[AbstractState, Action]] = field(default_factory=Counter)
    _failed: GroundOperator | None = None
    _needs: dict[Action, frozenset[Atom]] = field(default_factory=dict)

    def next(self) -> GroundOperator | None:
        """The step to execute now; None when the goal seems to hold.

        Raises ``GivenUpError`` when no plan is found any more, after ``max_replans`` new plans, or when a skill failed
        too often in this state and there is no other way.
        """
        self.turn, self.because = Turn.FOLLOWED, ()
        self._check(self._needed())
        self._go_on()
        self._be_cautious()
        if self._step() is None and self.resourceful:
            self._doubt_the_goal()
            self._go_on()
        chosen = self._step()
        if chosen is not None and chosen == self._failed:
            self.turn = Turn.REPEATED
        return chosen

    def executed(self, before: AbstractState, *, succeeded: bool) -> None:
        """The step was tried in the state ``before``."""
        step = self.plan[self.position]
        self._failed = None if succeeded else step
        if not succeeded:
            self._failures[before, step.action] += 1
            self._needs[step.action] = step.preconditions
        self.position += 1

    def _step(self) -> GroundOperator | None:
        return self.plan[self.position] if self.position < len(self.plan) else None

    def _needed(self) -> AbstractState:
        """What must hold now for the rest of the plan to succeed."""
        return necessary_atoms(self.plan, self._aim)[self.position]

    @property
    def _aim(self) -> Sequence[Atom]:
        """The goal that the plan is for."""
        return self._goal or self.goals[0]

    def _go_on(self) -> None:
        """With the plan at hand if it can be followed, or else with a new one."""
        needed, chosen = self._needed(), self._step()
        tried = chosen is not None and chosen.action in self._exhausted()
        if tried or not needed <= self.perception.state | self._assumed:
            self._plan_again(needed)

    def _check(self, needed: AbstractState) -> None:
        """Ask about what the rest of the plan needs, or is there to bring about, where it is in doubt."""
        state = self.perception.state | self._assumed
        surprises = self.perception.possible()
        self.perception.ask([a for a in surprises if a in needed - state], WhyAsked.SURPRISE)
        made = {a for step in self.plan[self.position :] for a in step.add if isinstance(a.predicate.source, FromVLM)}
        self.perception.ask(self.perception.doubts(needed | (made - state)), WhyAsked.IN_DOUBT)

    def _be_cautious(self) -> None:
        """Take a plan that does not rest on what is in doubt, if it is not much longer."""
        needed = self._needed() & self.perception.state
        doubted = [a for a in self.perception.doubts(needed) if self._cautions[a] < MOST_CAUTIONS]
        rest = self.plan[self.position :]
        safer = safer_plan(self._plan_from, self._aim, self.perception, rest, doubted)
        if safer is not None:
            self._cautions.update(doubted)
            self._adopt(safer, Turn.CAUTIOUS, doubted, ())

    def _doubt_the_goal(self) -> None:
        """What seems to hold of the goal, but may not: to go on costs little beside leaving it undone."""
        self.perception.ask(unsure(self._aim, self.perception), WhyAsked.IN_DOUBT)
        doubted = [a for a in unsure(self._aim, self.perception) if self._cautions[a] < MOST_CAUTIONS]
        if doubted:
            nearest = nearest_plan(lambda state: self._plan_from(state - set(doubted)), self.goals, self.perception)
            if nearest is not None and nearest.found.plan:
                self._cautions.update(doubted)
                self._adopt(nearest.found, Turn.CAUTIOUS, doubted, nearest.assumed)

    def _exhausted(self) -> Sequence[Action]:
        """Actions that failed again and again in this state: what is believed of it is not all there is to it."""
        state = self.perception.state
        failures = {a: times for (where, a), times in self._failures.items() if where == state}
        return [a for a, times in failures.items() if times >= (MOST_DRAWS if a.skill.dimension else MOST_TRIES)]

    def _plan_from(self, state: AbstractState) -> PlanResult:
        return self.plan_from(state, self._exhausted())

    def _plan_again(self, needed: AbstractState) -> None:
        lacking = needed - self.perception.state - self._assumed
        if self.replans >= self.max_replans:
            why = f"gave up after planning again {self.replans} times"
            raise GivenUpError(GivingUp.REPLANS, why)
        self.replans += 1
        exhausted = self._exhausted()
        if len(exhausted) >= MOST_WAYS:
            raise self._stuck(exhausted)
        found = self._plan_from(self.perception.state)
        if found.status == PlanStatus.SOLVED:
            self._adopt(found, Turn.OTHERWISE if exhausted else Turn.PLANNED_AGAIN, lacking, ())
            return
        nearest = nearest_plan(self._plan_from, self.goals, self.perception)
        if (nearest is None or nearest.assumed) and self.resourceful and self._otherwise(nearest, lacking):
            return
        if nearest is None or (nearest.assumed and not self.may_assume(nearest.assumed)):
            if exhausted:
                raise self._stuck(exhausted)
            missing = ", ".join(str(a) for a in sorted(lacking)[:MOST_NAMED])
            why = f"no plan any more ({found.status}) after {missing} turned out not to hold"
            raise GivenUpError(GivingUp.NO_PLAN, why)
        turn = Turn.ASSUMED if nearest.assumed else Turn.PLANNED_AGAIN
        self._adopt(nearest.found, turn, nearest.assumed or lacking, nearest.assumed)

    def _otherwise(self, nearest: NearestPlan | None, lacking: Iterable[Atom]) -> bool:
        """Try what was not learned, where that is likelier to help than what is probably not so; whether there is."""
        exhausted = self._exhausted()
        for licence, turn in LICENCES.items():
            if licence is Licence.AFTER_A_CHANGE and not exhausted:
                continue
            found = self.plan_from(self.perception.state, exhausted, licence)
            if found.status == PlanStatus.SOLVED and (
                nearest is None or simpler(found, UNLIKELY[licence], nearest, self.perception)
            ):
                self._adopt(found, turn, lacking, ())
                return True
        return False

    def _adopt(self, found: PlanResult, turn: Turn, because: Iterable[Atom], assumed: Iterable[Atom]) -> None:
        self.plan, self._goal, self.position, self.turn = found.plan, found.goal, 0, turn
        self.because, self._assumed = tuple(sorted(because)), frozenset(assumed)

    def _stuck(self, exhausted: Sequence[Action]) -> GivenUpError:
        needed = sorted({atom for action in exhausted for atom in self._needs[action]})
        suspects = sorted(unsure(needed, self.perception), key=self.perception.probability)
        why = f"{exhausted[-1]} failed again in a state that looks the same"
        return GivenUpError(GivingUp.STUCK, why, tuple(suspects[:1]))
