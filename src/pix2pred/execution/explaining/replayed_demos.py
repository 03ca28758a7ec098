"""The truth in demonstrations: their states are visited again in the simulator that made them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from pix2pred.execution.explaining.diagnosis import TruthOf, visual
from pix2pred.predicates import ground_atoms
from pix2pred.structs import Atom, Demo, Predicate
from pix2pred.structs.environment import Environment, SimulatedTask

TruthInDemo = Callable[[int, int, Atom], bool | None]
"""The true value of a visual atom in a state of a demonstration (by number); None for words without a truth."""

TruthNow = Callable[[Environment], TruthOf | None]
"""What is known of the truth in an environment's present state."""


def truths_of_demos(
    demos: Sequence[Demo],
    starts: Sequence[SimulatedTask],
    environment_for: Callable[[SimulatedTask], Environment],
    truth_now: TruthNow,
    predicates: Sequence[Predicate],
) -> TruthInDemo:
    """Visits the states of the demonstrations again and notes the truth of every visual atom of ``predicates``."""
    known: dict[tuple[int, int, Atom], bool] = {}
    for d, (demo, start) in enumerate(zip(demos, starts, strict=False)):
        environment = environment_for(start)
        environment.reset()
        atoms = ground_atoms(visual(predicates), demo.objects)
        for t in range(len(demo.states)):
            if t:
                environment.execute(demo.actions[t - 1])
            truth = truth_now(environment)
            for atom in atoms:
                value = truth(atom) if truth else None
                if value is not None:
                    known[d, t, atom] = value
    return lambda d, t, atom: known.get((d, t, atom))
