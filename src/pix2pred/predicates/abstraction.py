"""What an episode looks like in symbols while it unfolds (method 3.8)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pix2pred.predicates.initial import is_asked, local_values
from pix2pred.predicates.labelling.asking import Occurrence
from pix2pred.predicates.labelling.state_labels import StateLabeller, StateLabels, StepToLabel, UnusableAnswersError
from pix2pred.predicates.labelling.table import ground_atoms
from pix2pred.structs import AbstractState, Action, Atom, FromSkills, Label, Object, Predicate, State


class Abstraction:
    """Labels the states of one episode, each with the history before it, as demonstrations are labelled.

    Only groundings of ``predicates`` over ``objects`` are asked for. ``about`` names the task to people who read the
    questions; it is no part of them. There is no double check (method 3.5).
    """

    def __init__(
        self,
        objects: Sequence[Object],
        predicates: Sequence[Predicate],
        labeller: StateLabeller,
        about: str = "episode",
    ) -> None:
        self._about = about
        self._objects = objects
        self._labeller = labeller
        atoms = ground_atoms(predicates, objects)
        self._asked = [a for a in atoms if is_asked(a)]
        local = [a for a in atoms if not is_asked(a)]
        self._seen = [a for a in local if not isinstance(a.predicate.source, FromSkills)]
        self._declared = [a for a in local if isinstance(a.predicate.source, FromSkills)]
        self._states: list[State] = []
        self._actions: list[Action] = []
        self._labels = StateLabels({}, "")

    def start(self, state: State) -> AbstractState:
        """The atoms that hold in the first state."""
        self._states, self._actions = [state], []
        if self._asked:
            self._labels = self._labeller.first(state, self._objects, self._asked, about=f"{self._about}, state 0")
            if not self._labels.counts[Occurrence.READ]:
                raise UnusableAnswersError.after(self._labeller.vlm.name, [self._labels])
        return self._held()

    def advance(self, action: Action, state: State) -> AbstractState:
        """The atoms that hold in the state after ``action``."""
        before = self._states[-1]
        self._states.append(state)
        self._actions.append(action)
        if self._asked:
            step = StepToLabel(before, state, len(self._actions), action, self._labels)
            self._labels = self._labeller.next(step, self._objects, self._asked, f"{self._about}, state {step.t}")
        return self._held()

    def relist(self, given: Iterable[Atom]) -> AbstractState:
        """The atoms that hold in the latest state if ``given`` is what is listed there."""
        latest = self._states[-1]
        self._states[-1] = State(latest.pictures, latest.features, frozenset(given))
        return self._held()

    @property
    def labels(self) -> StateLabels:
        """What the model said about the latest state."""
        return self._labels

    def _held(self) -> AbstractState:
        latest = self._states[-1:]
        seen = (a for a in self._seen if local_values(a, latest, ())[-1] == Label.TRUE)
        declared = (a for a in self._declared if local_values(a, self._states, self._actions)[-1] == Label.TRUE)
        read = (a for a, value in self._labels.values.items() if value == Label.TRUE)
        return frozenset((*seen, *declared, *read))
