"""What is known of states where a goal says what must not hold (``structs.goals``)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pix2pred.execution.belief.perception import Perception
from pix2pred.predicates import StateLabels
from pix2pred.structs import AbstractState, Atom, GroundOperator, Predicate, Question, State, Task, WhyAsked, WorldModel
from pix2pred.structs.environment import StepStatus
from pix2pred.structs.goals.opposites import as_learned, contrary, is_denial, with_denials


class SeeingDenials:
    """A perception whose states hold the opposites of what does not hold, for the predicates ``denied``.

    Nobody is asked about an opposite: what is known of it is what is known of the atom itself.
    """

    def __init__(self, seen: Perception, model: WorldModel, task: Task, denied: frozenset[Predicate]) -> None:
        self._seen, self._model, self._objects, self._denied = seen, model, task.objects, denied

    @property
    def state(self) -> AbstractState:
        """The state from which planning goes on."""
        return with_denials(self._seen.state, self._denied, self._objects)

    @property
    def labels(self) -> StateLabels:
        """What the model said in the latest look."""
        return self._seen.labels

    @property
    def questions(self) -> Sequence[Question]:
        """All atoms asked about again so far."""
        return self._seen.questions

    @property
    def suspects(self) -> tuple[Atom, ...]:
        """Atoms whose labels contradict all else that is known."""
        return self._seen.suspects

    def start(self, state: State) -> AbstractState:
        self._seen.start(state)
        return self.state

    def advance(self, step: GroundOperator, state: State, reported: StepStatus | None) -> AbstractState:
        self._seen.advance(as_learned(step, self._model.operators), state, reported)
        return self.state

    def relist(self, given: Iterable[Atom]) -> AbstractState:
        self._seen.relist([a for a in given if not is_denial(a)])
        return self.state

    def doubts(self, atoms: Iterable[Atom]) -> tuple[Atom, ...]:
        wanted = set(atoms)
        doubted = self._seen.doubts(dict.fromkeys(contrary(a) if is_denial(a) else a for a in sorted(wanted)))
        return tuple(b for a in doubted for b in self._both(a) if b in wanted)

    def probability(self, atom: Atom) -> float:
        return 1 - self._seen.probability(contrary(atom)) if is_denial(atom) else self._seen.probability(atom)

    def possible(self) -> tuple[Atom, ...]:
        held = [a for a in self._seen.state if a.predicate in self._denied]
        return (*self._seen.possible(), *(contrary(a) for a in self._seen.doubts(sorted(held))))

    def ask(self, atoms: Sequence[Atom], why: WhyAsked) -> bool:
        return self._seen.ask(list(dict.fromkeys(contrary(a) if is_denial(a) else a for a in atoms)), why)

    def _both(self, atom: Atom) -> tuple[Atom, ...]:
        return (atom, contrary(atom)) if atom.predicate in self._denied else (atom,)
