"""The belief about one scene: log odds per atom, carried through skills and joined with labels (method 8.6).

The model is a hidden Markov chain per atom (as in learning), with three sources of evidence that are kept apart: what
came before and what skills did, what labels said since, and what invariants say. Given atoms are certain. A skill that
reports failure, or whose given effects are seen or not, tells about its preconditions as well.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from pix2pred.execution.belief.constraints import Constraints
from pix2pred.execution.belief.evidence import Answers, log_odds, probability_of, within
from pix2pred.execution.belief.settings import DEFAULTS, BeliefSettings
from pix2pred.predicates import ground_atoms
from pix2pred.structs import AbstractState, Atom, FromVLM, GroundOperator, Object, Predicate, WorldModel
from pix2pred.structs.environment import StepStatus

NO_ANSWER = Answers()


@dataclass(frozen=True, slots=True)
class Reading:
    """A label that says true or false; ``confidence`` is the model's own probability of it, where known.

    One that is ``calibrated`` was measured on what was left out, so that nothing else is known of the label's error;
    models that were not measured are often too sure of themselves.
    """

    value: bool
    confidence: float | None = None
    calibrated: bool = False


Readings = Mapping[Atom, Reading]
"""What one look says; atoms with an unknown label are absent, for that is no evidence."""


MOST_ERROR = 0.45
"""No label is taken to be worse than this: labels that are wrong half of the time say nothing."""


@dataclass(slots=True)
class Track:
    """What is known of one atom, as log odds: ``past`` from before and from skills, ``labels`` from labels since.

    ``said`` is the latest label, and ``answers``, with it, were given about the latest picture, each wrong with
    probability ``error``. ``tested``: a skill has told something about the atom; ``agreed``: since then, some label
    agreed with all else that is known; ``conflicts`` counts the labels that contradicted it before any agreed. A change
    that nobody foresaw looks different: there, labels agree first.
    """

    past: float
    labels: float = 0.0
    said: bool | None = None
    answers: Answers = NO_ANSWER
    error: float = 0.0
    tested: bool = False
    agreed: bool = False
    conflicts: int = 0

    def test(self, odds: float) -> None:
        """A skill told what ``past`` is to be."""
        self.past, self.tested, self.agreed = odds, True, False

    def compare(self, agrees: bool) -> None:
        """A label is compared with what is known otherwise, and well."""
        if agrees:
            self.agreed, self.conflicts = True, 0
        elif self.tested and not self.agreed:
            self.conflicts += 1


@dataclass(slots=True)
class ErrorRate:
    """How often labels of a predicate are wrong: an estimate that counts for ``weight`` labels, and those since."""

    estimate: float
    weight: float
    wrong: float = 0.0
    labels: int = 0

    @property
    def now(self) -> float:
        """The present estimate."""
        return min(MOST_ERROR, (self.wrong + self.weight * self.estimate) / (self.labels + self.weight))

    def count(self, wrong: float) -> None:
        """One label more, which is wrong with probability ``wrong``."""
        self.wrong += wrong
        self.labels += 1


class Belief:
    """What is believed about the visual atoms of one task's objects. Atoms are numbered, for speed."""

    def __init__(self, model: WorldModel, objects: Sequence[Object], settings: BeliefSettings = DEFAULTS) -> None:
        self._settings = settings
        known = {r.predicate: r for r in model.reliability}
        visual = [p for p in model.predicates if isinstance(p.source, FromVLM)]
        self.atoms = ground_atoms(visual, objects)
        self._number = {a: i for i, a in enumerate(self.atoms)}
        self._rates = {
            p: ErrorRate(known[p].error if p in known else settings.error, settings.prior_labels) for p in visual
        }
        first = {p: known[p].initially if p in known else settings.initially for p in visual}
        self._tracks = [Track(log_odds(first[a.predicate])) for a in self.atoms]
        self._constraints = Constraints(model.invariants, objects, self.atoms)
        self._bound = log_odds(1 - settings.certain)
        self._most_labels = log_odds(1 - settings.misread)
        self._certainly = log_odds(1 - settings.doubt)
        self.certain: AbstractState = frozenset()
        self._failed: set[GroundOperator] = set()
        self._odds = [t.past for t in self._tracks]
        self._state: AbstractState | None = None

    def odds(self, atom: Atom) -> float:
        """The log odds of ``atom``; infinite for given atoms."""
        number = self._number.get(atom)
        if number is not None:
            return self._odds[number]
        return math.inf if atom in self.certain else -math.inf

    def probability(self, atom: Atom) -> float:
        """How probable it is that ``atom`` holds."""
        return probability_of(self.odds(atom))

    def doubted(self, atom: Atom) -> bool:
        """Whether the value of ``atom`` is in doubt."""
        return abs(self.odds(atom)) < self._certainly

    @property
    def state(self) -> AbstractState:
        """The most probable consistent state."""
        if self._state is None:
            held = self._constraints.consistent(self._odds)
            self._state = self.certain | {a for a, h in zip(self.atoms, held, strict=True) if h}
        return self._state

    @property
    def suspects(self) -> tuple[Atom, ...]:
        """Atoms whose labels contradict everything else that is known about them, look after look, sorted."""
        return tuple(a for a, t in zip(self.atoms, self._tracks, strict=True) if self._suspected(t))

    def _suspected(self, track: Track) -> bool:
        return track.conflicts >= self._settings.suspect_after

    def start(self, certain: AbstractState, readings: Readings) -> None:
        """The first look."""
        self._join(certain, readings)

    def advance(
        self, step: GroundOperator, reported: StepStatus | None, certain: AbstractState, readings: Readings
    ) -> None:
        """A look after ``step`` was tried; ``reported`` is how it ended, where somebody says so."""
        exact = [a for a in sorted((*step.add, *step.delete)) if a not in self._number]
        worked = self._worked(step, reported, certain, exact)
        failed = reported not in (StepStatus.DONE, None)
        if (exact or reported is not None) and not (failed and step in self._failed):
            self._blame(step, worked)
        self._failed = {*self._failed, step} if failed else set()
        success = worked.posterior(self._holds(step.preconditions))
        drift = self._settings.drift
        added, deleted = self._numbers(step.add), self._numbers(step.delete)
        for number, track in enumerate(self._tracks):
            if number in added or number in deleted:
                before = probability_of(track.past + track.labels)
                after = before + (1 - before) * success if number in added else before * (1 - success)
                track.test(within(log_odds(after), self._bound))
                track.labels = 0.0
            else:
                before = probability_of(track.past)
                track.past = log_odds(before * (1 - drift) + (1 - before) * drift)
        self._join(certain, readings, afresh=not failed)

    def given_are(self, certain: AbstractState) -> None:
        """Somebody tells which given atoms hold now."""
        self.certain = certain
        self._constraints.given_are(certain)
        self._inform()

    def answered(self, atom: Atom, value: bool) -> None:
        """A further answer about the picture of the latest look."""
        track = self._tracks[self._number[atom]]
        track.error = track.error or self.error(atom.predicate)
        self._answer(track, value)
        self._inform()

    def error(self, predicate: Predicate) -> float:
        """The error rate of a predicate: the model's estimate, adjusted by the labels of this episode."""
        return self._rates[predicate].now

    def _numbers(self, atoms: Iterable[Atom]) -> set[int]:
        return {self._number[a] for a in atoms if a in self._number}

    def _join(self, certain: AbstractState, readings: Readings, *, afresh: bool = True) -> None:
        """Add the labels of a look, and learn from them how often labels are wrong.

        After a skill that failed the scene is mostly what it was: unless it is looked at ``afresh``, labels are further
        answers about the latest picture, and one that is repeated tells nothing.
        """
        for track in self._tracks if afresh else ():
            track.said, track.answers, track.error = None, NO_ANSWER, 0.0
        self.given_are(certain)
        read = [
            (number, a.predicate, reading)
            for a, reading in readings.items()
            if self._tracks[number := self._number[a]].said != reading.value
        ]
        for number, predicate, reading in read:
            track = self._tracks[number]
            if track.answers == NO_ANSWER:
                track.error = self.error(predicate)
            if reading.confidence is not None:
                least = self._settings.misread if reading.calibrated else track.error
                track.error = min(MOST_ERROR, max(least, 1 - reading.confidence))
            otherwise = self._odds[number] - (0.0 if self._suspected(track) else track.labels)
            if abs(otherwise) > self._certainly:
                track.compare(reading.value == (otherwise > 0))
            track.said = reading.value
            self._answer(track, reading.value)
        self._inform()
        for number, predicate, reading in read:
            right = probability_of(self._odds[number])
            self._rates[predicate].count(1 - right if reading.value else right)

    def _answer(self, track: Track, value: bool) -> None:
        """One answer more about the latest picture."""
        before, track.answers, sticky = track.answers, track.answers.plus(value), self._settings.sticky
        evidence = track.answers.log_odds(track.error, sticky) - before.log_odds(track.error, sticky)
        track.labels = within(track.labels + evidence, self._most_labels)

    def _inform(self) -> None:
        """Labels of suspected atoms count for nothing."""
        local = [t.past + (0.0 if self._suspected(t) else t.labels) for t in self._tracks]
        self._odds = self._constraints.informed(local)
        self._state = None

    def _holds(self, atoms: Iterable[Atom]) -> float:
        """The probability that all of ``atoms`` hold."""
        return math.prod(self.probability(a) for a in sorted(atoms))

    def _worked(
        self, step: GroundOperator, reported: StepStatus | None, certain: AbstractState, exact: Sequence[Atom]
    ) -> _Worked:
        """How likely the report and what is known for certain after ``step`` are, if it had its effects, and if not."""
        settings = self._settings
        works, seen, unseen = 1 - settings.fails_unreported, 1.0, 1.0
        if reported is StepStatus.DONE:
            works = 1 - settings.fails
        elif reported is not None:
            seen, unseen = settings.false_alarm, settings.noticed
        changed = [a for a in exact if (a in self.certain) != (a in step.add)]
        if changed:
            occurred = all((a in certain) == (a in step.add) for a in changed)
            seen *= 1 - settings.unseen if occurred else settings.unseen
            unseen *= settings.unseen if occurred else 1 - settings.unseen
        return _Worked(works, settings.works_without, seen, unseen)

    def _blame(self, step: GroundOperator, worked: _Worked) -> None:
        """What the outcome says about the preconditions in doubt, each given the others (Bayes' rule)."""
        doubted = [a for a in sorted(step.preconditions) if a in self._number]
        together = {a: self._holds(step.preconditions - {a}) for a in doubted}
        for atom in doubted:
            track = self._tracks[self._number[atom]]
            if_true, if_false = worked.likelihood(together[atom]), worked.likelihood(0.0)
            track.test(within(track.past + math.log(if_true) - math.log(if_false), self._bound))


@dataclass(frozen=True, slots=True)
class _Worked:
    """Whether a skill had its effects.

    ``works`` is the prior probability when all preconditions hold, ``without`` when not; ``seen`` and ``unseen`` are
    the likelihoods of what is reported and known for certain afterwards if it had its effects, and if it had not.
    """

    works: float
    without: float
    seen: float
    unseen: float

    def prior(self, holding: float) -> float:
        """The probability of success when the preconditions hold with probability ``holding``."""
        return self.works * holding + self.without * (1 - holding)

    def likelihood(self, holding: float) -> float:
        """How likely the outcome is."""
        works = self.prior(holding)
        return works * self.seen + (1 - works) * self.unseen

    def posterior(self, holding: float) -> float:
        """The probability of success given the outcome."""
        return self.prior(holding) * self.seen / self.likelihood(holding)
