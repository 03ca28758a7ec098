"""One episode in a home domain: skills that work or fail with a cause, pictures by the body that acts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from pix2pred.domains.given import holding
from pix2pred.domains.home.cameras import camera_names, pictures, pixels_of
from pix2pred.domains.home.world import World
from pix2pred.domains.scripted import check_skill
from pix2pred.structs import Action, Application, Atom, Object, Predicate, Skill, State, Type
from pix2pred.structs.environment import FrameSink, Step, StepStatus
from pix2pred.structs.predicates import FromDomain
from pix2pred.structs.samplers import Features

HORIZON = 120
"""Skills in one episode."""


class SkillFailedError(Exception):
    """A skill did not reach its end. ``world`` is what it left behind, ``None`` when it changed nothing."""

    def __init__(self, why: str, world: World | None = None) -> None:
        super().__init__(why)
        self.world = world


Behaviour = Callable[..., World]
"""Takes the world and the names of a skill's objects; gives the world afterwards or raises ``SkillFailedError``."""

Classifier = Callable[..., bool]
"""Takes the world and the names of a predicate's objects."""


class Rules:
    """What a home domain is made of: types, skills and what they do, given predicates and when they hold."""

    def __init__(
        self, types: Sequence[Type], skills: Mapping[Skill, Behaviour], given: Mapping[Predicate, Classifier]
    ) -> None:
        self.types = {t.name: t for t in types}
        self.skills = {s.name: s for s in skills}
        self.behaviours = {s.name: b for s, b in skills.items()}
        self.given = tuple(given)
        self._classifiers = {p.name: c for p, c in given.items()}

    def objects(self, world: World) -> tuple[Object, ...]:
        """All objects of ``world``, sorted; descriptors say what one sees of them."""
        phrases = world.phrases()
        return tuple(sorted(Object(n, self.types[t], phrases[n]) for n, t in world.types().items()))

    def holds(self, world: World, atom: Atom) -> bool:
        """Whether a given atom is true. Raises ``ValueError`` for a predicate of another domain."""
        if atom.predicate.name not in self._classifiers:
            raise ValueError(f"{atom.predicate.name} is not a given predicate of this domain")
        return self._classifiers[atom.predicate.name](world, *(o.name for o in atom.objects))

    def told(self, world: World) -> frozenset[Atom]:
        """The true atoms that the actor knows without looking."""
        known = [p for p in self.given if isinstance(p.source, FromDomain)]
        return holding(known, self.objects(world), partial(self.holds, world))

    def observe(self, world: World) -> State:
        """The state seen in ``world``: pictures and what the actor feels; no features."""
        return State(pictures(world), {}, self.told(world))


class HomeEnvironment:
    """An episode that starts in ``initial``. ``world`` is the ground truth; only states are meant to leave."""

    def __init__(self, rules: Rules, initial: World, goal: Sequence[Atom]) -> None:
        self.world = initial
        self.steps = 0
        self._rules = rules
        self._initial = initial
        self._goal = tuple(goal)
        self._sink: FrameSink | None = None

    def reset(self) -> None:
        """Start the episode over."""
        self.world, self.steps = self._initial, 0

    def observe(self) -> State:
        """The state now."""
        return self._rules.observe(self.world)

    def features(self) -> Features:
        """None: these domains have no object features."""
        return {}

    def film(self, sink: FrameSink | None) -> None:
        """From now on hand ``sink`` the last camera's picture after every skill; ``None`` stops."""
        self._sink = sink

    def goal_reached(self) -> bool:
        """Whether every goal atom is true of the world now."""
        return all(self._rules.holds(self.world, atom) for atom in self._goal)

    def execute(self, action: Action) -> Step:
        """Run one skill. It never raises: what cannot work is ``STUCK`` with a sentence about the cause."""
        skill = Application(action.skill.name, tuple(o.name for o in action.objects))
        scene = {o.name: o.type for o in self._rules.objects(self.world)}
        try:
            check_skill(skill, self._rules.skills, scene)
        except ValueError as error:
            return Step(StepStatus.STUCK, f"{skill} cannot be run: {error}")
        if action.params:
            return Step(StepStatus.STUCK, f"{skill} cannot be run: it takes no parameters, found {len(action.params)}")
        if self.steps >= HORIZON:
            return Step(StepStatus.HORIZON, f"{skill} was not begun: {HORIZON} skills were used up")
        self.steps += 1
        step = Step(StepStatus.DONE)
        try:
            self.world = self._rules.behaviours[skill.name](self.world, *skill.args[1:])
        except SkillFailedError as error:
            self.world = error.world or self.world
            step = Step(StepStatus.STUCK, f"{skill} failed: {error}")
        if self._sink:
            self._sink(pixels_of(self.world, camera_names(self.world)[-1]))
        return step
