"""What is allowed in a project and will hurt in learning all the same."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from pix2pred.demos.by_skills import contradictions
from pix2pred.demos.declared import Declared
from pix2pred.demos.files.documents import DemoDoc, DomainDoc, load_document
from pix2pred.demos.files.folders import DEMO, DEMOS, DOMAIN, IMAGES
from pix2pred.demos.files.problems import Problem
from pix2pred.demos.files.yaml_lines import Loc
from pix2pred.demos.read import Project, StoredTask
from pix2pred.structs import Atom, Demo, FromDomain, FromFeatures, FromHuman, FromOpposite, FromSkills, FromVLM, State
from pix2pred.structs.expressions import ExpressionError, evaluate, parse_expression
from pix2pred.structs.goals.opposites import contrary


def cautions(directory: Path, project: Project, declared: Declared, tasks: Sequence[StoredTask]) -> list[Problem]:
    """Warnings about a ``project`` that was read from ``directory`` without a problem."""
    return [
        *_few(directory, project),
        *_skills(directory, project),
        *_objects(directory, project, declared, tasks),
        *_listed(directory, project),
        *(warning for demo in project.demos for warning in _demo(directory, demo, project)),
    ]


def _few(directory: Path, project: Project) -> Iterator[Problem]:
    if len(project.demos) == 1:
        message = "holds one demonstration; what always holds in it will be taken for a rule: add others that differ"
        yield Problem(directory / DEMOS, None, message)


def _skills(directory: Path, project: Project) -> Iterator[Problem]:
    """Skills that are never seen cannot be learned; one that is seen once gets the preconditions of that one time."""
    seen = Counter(action.skill.name for demo in project.demos for action in demo.actions if not action.failed)
    lines = _Lines(directory / DOMAIN, directory, DomainDoc)
    for i, skill in enumerate(project.vocabulary.skills):
        if seen[skill.name] == 0:
            yield lines.problem(("skills", i), f"skill {skill.name} is in no demonstration: it will not be in any plan")
        elif seen[skill.name] == 1:
            message = f"skill {skill.name} is seen once: all that held then will be taken for its precondition"
            yield lines.problem(("skills", i), message)


def _objects(directory: Path, project: Project, declared: Declared, tasks: Sequence[StoredTask]) -> Iterator[Problem]:
    """Objects that nothing is done with: they cost queries, and the model is asked about them for nothing."""
    used = {o for demo in project.demos for a in demo.actions for o in a.objects}
    used |= {o for demo in project.demos for goal in demo.goals for atom in goal for o in atom.objects}
    listed = {o for demo in project.demos for o in demo.objects}
    wanted = {o for stored in tasks for o in stored.task.objects}
    lines = _Lines(directory / DOMAIN, directory, DomainDoc)
    for name, item in declared.objects.items():
        if item not in listed | wanted:
            yield lines.problem(("objects", name), f"object {name} is in no demonstration and no task")
    said = set()
    for demo in project.demos:
        here = _Lines(directory / DEMOS / demo.name / DEMO, directory, DemoDoc)
        unused: dict[int | None, list[str]] = {}
        for i, item in enumerate(demo.objects):
            if item not in used and item not in said:
                said.add(item)
                line = here.line(("objects", i), ("objects", item.name))
                unused.setdefault(line, []).append(item.name)
        for line, names in unused.items():
            what = f"object {names[0]} is" if len(names) == 1 else f"objects {', '.join(names)} are"
            yield Problem(here.file, line, f"{what} never mentioned by an action or a goal, here or elsewhere")


def _listed(directory: Path, project: Project) -> Iterator[Problem]:
    """Atoms that a person has to list and that are listed nowhere: forgotten rather than false."""
    listed = {atom.predicate for demo in project.demos for state in demo.states for atom in state.given}
    lines = _Lines(directory / DOMAIN, directory, DomainDoc)
    for i, predicate in enumerate(project.vocabulary.initial):
        if isinstance(predicate.source, FromHuman) and predicate not in listed:
            message = f"{predicate.signature} is listed under 'given' in no state: it is taken for false everywhere"
            yield lines.problem(("predicates", i), message)


def _demo(directory: Path, demo: Demo, project: Project) -> Iterator[Problem]:
    lines = _Lines(directory / DEMOS / demo.name / DEMO, directory, DemoDoc)
    if not any(state.pictures for state in demo.states):
        where = f"{IMAGES}/0/main.jpg"
        yield lines.problem(("states",), f"no state has a picture: put the photo of the first at {where}, and so on")
    if any(goal and all(_at_start(atom, demo.states[0]) for atom in goal) for goal in demo.goals):
        yield lines.problem(("goal",), "the goal already holds at the start: nothing is demonstrated")
    for loc, message in contradictions(demo, project.vocabulary.initial):
        yield lines.problem(loc, message)


def _at_start(atom: Atom, state: State) -> bool:
    """Whether ``atom`` is known to hold in the first ``state`` of a demonstration, before any model is asked."""
    match atom.predicate.source:
        case FromDomain() | FromHuman():
            return atom in state.given
        case FromSkills() as source:
            return source.initially or atom in state.given
        case FromFeatures(expression):
            try:
                return evaluate(parse_expression(expression), state, atom.objects)
            except ExpressionError:
                return False
        case FromOpposite(of):
            return isinstance(of.source, FromDomain | FromHuman) and contrary(atom) not in state.given
        case FromVLM():
            return False


class _Lines:
    """The lines of a file that has been read before."""

    def __init__(self, file: Path, root: Path, document: type[DomainDoc] | type[DemoDoc]) -> None:
        self.file = file
        loaded = load_document(file, root, document, [])
        self._yaml = loaded[0].yaml if loaded else None

    def line(self, loc: Loc, named: Loc = ()) -> int | None:
        """The line of ``loc``, or of ``named`` where entries have names instead of positions."""
        if self._yaml is None:
            return None
        return self._yaml.line(named if named and named in self._yaml.lines else loc)

    def problem(self, loc: Loc, message: str) -> Problem:
        """A warning about the entry at ``loc``."""
        return Problem(self.file, self.line(loc), message)
