"""How an episode comes to know its states: labels taken at their word, or a belief that may ask again."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

from pix2pred.execution.belief.belief import Belief, Reading
from pix2pred.execution.belief.settings import DEFAULTS, BeliefSettings
from pix2pred.execution.belief.unlabelled import unlabelled
from pix2pred.predicates import Abstraction, StateLabeller, StateLabels
from pix2pred.predicates.labelling.again import WORDINGS, SecondLook
from pix2pred.structs import (
    AbstractState,
    Atom,
    GroundOperator,
    Label,
    Question,
    State,
    Task,
    WhyAsked,
    WorldModel,
)
from pix2pred.structs.environment import StepStatus
from pix2pred.vlm.request import Leaning

ASK_AGAIN = 4
"""Atoms that may be asked about again in one look: a surprise rarely concerns more."""


class Perception(Protocol):
    """What is known of the states of one episode, one look after the other."""

    @property
    def state(self) -> AbstractState:
        """The state from which planning goes on."""
        ...

    @property
    def labels(self) -> StateLabels:
        """What the model said in the latest look."""
        ...

    @property
    def questions(self) -> Sequence[Question]:
        """All atoms asked about again so far."""
        ...

    @property
    def suspects(self) -> tuple[Atom, ...]:
        """Atoms whose labels contradict all else that is known."""
        ...

    def start(self, state: State) -> AbstractState:
        """The first look."""
        ...

    def advance(self, step: GroundOperator, state: State, reported: StepStatus | None) -> AbstractState:
        """A look after ``step`` was tried; ``reported`` is how it ended, where somebody says so."""
        ...

    def relist(self, given: Iterable[Atom]) -> AbstractState:
        """The latest state if ``given`` is what a person lists there."""
        ...

    def doubts(self, atoms: Iterable[Atom]) -> tuple[Atom, ...]:
        """Those of ``atoms`` whose value is in doubt, the most doubtful first."""
        ...

    def probability(self, atom: Atom) -> float:
        """How probable it is that ``atom`` holds."""
        ...

    def possible(self) -> tuple[Atom, ...]:
        """Atoms taken for false that may be true all the same, the most probable first."""
        ...

    def ask(self, atoms: Sequence[Atom], why: WhyAsked) -> bool:
        """Ask about ``atoms`` again, as far as the budget goes; whether the state changed."""
        ...


Perceiving = Callable[[WorldModel, Task, StateLabeller], Perception]
"""Makes the perception of one episode."""


class AtTheirWord:
    """Every label is believed, and unknown ones are false: what open-loop plans of the paper rest on."""

    questions: Sequence[Question] = ()
    suspects: tuple[Atom, ...] = ()

    def __init__(self, model: WorldModel, task: Task, labeller: StateLabeller) -> None:
        self._abstraction = Abstraction(task.objects, model.predicates, labeller, about=f"task {task.name}")
        self.state: AbstractState = frozenset()

    @property
    def labels(self) -> StateLabels:
        """What the model said in the latest look."""
        return self._abstraction.labels

    def start(self, state: State) -> AbstractState:
        self.state = self._abstraction.start(state)
        return self.state

    def advance(self, step: GroundOperator, state: State, reported: StepStatus | None) -> AbstractState:
        self.state = self._abstraction.advance(step.action, state)
        return self.state

    def relist(self, given: Iterable[Atom]) -> AbstractState:
        self.state = self._abstraction.relist(given)
        return self.state

    def doubts(self, atoms: Iterable[Atom]) -> tuple[Atom, ...]:
        return ()

    def probability(self, atom: Atom) -> float:
        return float(atom in self.state)

    def possible(self) -> tuple[Atom, ...]:
        return ()

    def ask(self, atoms: Sequence[Atom], why: WhyAsked) -> bool:
        return False


@dataclass(frozen=True, slots=True)
class Believing:
    """Makes perceptions that weigh labels; at most ``ask_again`` atoms are asked about again after each look."""

    ask_again: int = ASK_AGAIN
    settings: BeliefSettings = DEFAULTS

    def __call__(self, model: WorldModel, task: Task, labeller: StateLabeller) -> BelievingPerception:
        return BelievingPerception(model, task, labeller, self)


class BelievingPerception:
    """A belief that is carried through the executed skills and joined with what is seen."""

    def __init__(self, model: WorldModel, task: Task, labeller: StateLabeller, how: Believing) -> None:
        self._calibrated = isinstance(labeller.vlm, Leaning)
        leaning = labeller.asking(labeller.vlm.leaning()) if isinstance(labeller.vlm, Leaning) else labeller
        self._abstraction = Abstraction(task.objects, model.predicates, leaning, about=f"task {task.name}")
        self._second_look = SecondLook(labeller)
        self._objects = task.objects
        self._how = how
        self.belief = Belief(model, task.objects, how.settings)
        self._shown = State()
        self._looks = 0
        self._asked: set[Atom] = set()
        self._left = 0
        self.questions: list[Question] = []

    @property
    def state(self) -> AbstractState:
        """The most probable consistent state."""
        return self.belief.state

    @property
    def labels(self) -> StateLabels:
        """What the model said in the latest look."""
        return self._abstraction.labels

    @property
    def suspects(self) -> tuple[Atom, ...]:
        """Atoms whose labels contradict all else that is known."""
        return self.belief.suspects

    def start(self, state: State) -> AbstractState:
        self._shown, self._looks = state, 0
        self._asked, self._left = set(), self._how.ask_again
        held = self._abstraction.start(state)
        self.belief.start(self._given(held), self._readings())
        return self.state

    def advance(self, step: GroundOperator, state: State, reported: StepStatus | None) -> AbstractState:
        self._shown, self._looks = state, self._looks + 1
        self._asked = set() if reported in (None, StepStatus.DONE) else self._asked
        self._left = self._how.ask_again
        held = self._abstraction.advance(step.action, state)
        self.belief.advance(step, reported, self._given(held), self._readings())
        return self.state

    def relist(self, given: Iterable[Atom]) -> AbstractState:
        self.belief.given_are(self._given(self._abstraction.relist(given)))
        return self.state

    def doubts(self, atoms: Iterable[Atom]) -> tuple[Atom, ...]:
        doubted = [a for a in atoms if self.belief.doubted(a)]
        return tuple(sorted(doubted, key=lambda a: (abs(self.belief.odds(a)), a)))

    def probability(self, atom: Atom) -> float:
        return self.belief.probability(atom)

    def possible(self) -> tuple[Atom, ...]:
        state, least = self.state, self._how.settings.unlikely
        likely = [a for a in self.belief.atoms if a not in state and self.belief.probability(a) >= least]
        return tuple(sorted(likely, key=lambda a: (-self.belief.odds(a), a)))

    def ask(self, atoms: Sequence[Atom], why: WhyAsked) -> bool:
        """No atom is asked about twice in one scene: the questions of each are used up by then."""
        before = self.state
        for atom in atoms:
            if atom in self._asked or atom not in self._abstraction.labels.values:
                continue
            if not self._left:
                break
            self._left -= 1
            self._asked.add(atom)
            self._ask(atom, why)
        return self.state != before

    def _ask(self, atom: Atom, why: WhyAsked) -> None:
        before, state = self.belief.probability(atom), self.state
        answers: list[Label] = []
        for number in range(len(WORDINGS)):
            answer = self._second_look.ask(self._shown, self._looks, self._objects, atom, number)
            answers.append(answer)
            if answer != Label.UNKNOWN:
                self.belief.answered(atom, answer == Label.TRUE)
            if not self.belief.doubted(atom):
                break
        after = self.belief.probability(atom)
        words = tuple(a.word for a in answers)
        changed = self.state != state
        self.questions.append(Question(self._looks, atom, why, words, round(before, 4), round(after, 4), changed))

    def _given(self, held: AbstractState) -> AbstractState:
        return frozenset(a for a in held if a not in self._abstraction.labels.values)

    def _readings(self) -> dict[Atom, Reading]:
        """The labels that say something: an atom without an answer keeps a value that nobody saw."""
        labels = self._abstraction.labels
        silent = set(unlabelled(labels))
        return {
            a: Reading(value == Label.TRUE, labels.confidence.get(a), self._calibrated)
            for a, value in labels.values.items()
            if a not in silent
        }
