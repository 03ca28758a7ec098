"""Words with definitions: one question per kind of demonstration, each told what is defined already."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from pix2pred.predicates.frugal.definitions import (
    defined_lines,
    is_placeholder,
    read_definition,
    skill_lines,
)
from pix2pred.predicates.prompt import action_text, fill, kind_lines, meaning_lines, object_lines
from pix2pred.predicates.proposing.lift import lift
from pix2pred.predicates.proposing.parse_atoms import clean, mentions
from pix2pred.predicates.proposing.propose import (
    ANSWER_TOKENS,
    Proposal,
    ProposalSettings,
    ProposedAtom,
    Rejection,
    about_demo,
    answered_proposal,
    judged,
    limit_text,
    parts_of,
    refuse_empty,
)
from pix2pred.structs import Demo, FromVLM, Predicate, Skill
from pix2pred.structs.goals.opposites import affirmed
from pix2pred.system.progress import Progress, Stage, silent
from pix2pred.vlm import VLM, Purpose, Request

NOTHING = "(nothing)"
"""Stands in a prompt where a list is empty."""


def propose_words(
    demos: Sequence[Demo],
    vlm: VLM,
    settings: ProposalSettings,
    given: Sequence[Predicate] = (),
    *,
    max_pictures: int | None = None,
    progress: Progress = silent,
) -> tuple[Proposal, ...]:
    """One proposal for every kind of demonstration, in order. Raises ``EmptyProposalError`` if all are empty.

    A demonstration of more than ``max_pictures`` pictures is asked about in parts, with a proposal for each.

    A demonstration is asked about when it has a skill with types of arguments, or a type of object, that none before
    it had. Every question tells the words of the answers before, so that one meaning has one word; the predicates
    ``given`` beforehand; and the skills of all demonstrations, since any of them may change what a word means.
    """
    skills = [a.skill for demo in demos for a in demo.actions]
    chosen = tuple(new_kinds(demos))
    proposals: list[Proposal] = []
    for done, demo in enumerate(chosen, start=1):
        for part in parts_of(demo, max_pictures):
            known = [c.predicate for c in lift(proposals)]
            proposals.append(
                answered_proposal(
                    demo.name,
                    vlm,
                    lambda attempt, budget, demo=demo, known=known, part=part: words_request(  # type: ignore[misc]
                        demo, known, settings, given, skills, attempt, budget, part
                    ),
                    lambda answer, demo=demo: read_words(demo, answer, settings, told(demo, given)),  # type: ignore[misc]
                    settings.attempts,
                )
            )
        progress(Stage.PROPOSE, done, len(chosen), demo.name)
    return refuse_empty(vlm, proposals)


def new_kinds(demos: Sequence[Demo]) -> Iterator[Demo]:
    """The demonstrations that show a skill on types of objects, or a type of object, for the first time."""
    seen: set[tuple[str, ...]] = set()
    for demo in demos:
        kinds = {(a.skill.name, *(o.type.name for o in a.objects)) for a in demo.actions}
        kinds |= {(o.type.name,) for o in demo.objects}
        if kinds - seen:
            yield demo
        seen |= kinds


def words_request(
    demo: Demo,
    known: Sequence[Predicate],
    settings: ProposalSettings,
    given: Iterable[Predicate] = (),
    skills: Iterable[Skill] = (),
    attempt: int = 0,
    budget: int = ANSWER_TOKENS,
    part: range | None = None,
) -> Request:
    """The question about one demonstration, or the states ``part`` of it.

    What is the same in every question stands first: prompt caches hit.
    """
    times = range(len(demo.states)) if part is None else part
    known_elsewhere = told(demo, given)
    text = fill(
        "frugal_propose",
        limit=limit_text(settings),
        skills=skill_lines([*skills, *(a.skill for a in demo.actions)]),
        given=meaning_lines(known_elsewhere) or NOTHING,
        defined=defined_lines(known) or NOTHING,
        objects=object_lines(demo.objects),
        kinds=kind_lines(demo.objects),
        actions="\n".join(f"{t}. {action_text(demo.actions[t])}" for t in times[:-1]),
    )
    request = about_demo(
        Purpose.DEFINE,
        text,
        demo,
        times,
        settings,
        lambda a: read_words(demo, a, settings, known_elsewhere),
        number_skills=True,
    )
    return replace(request, attempt=attempt, max_tokens=budget)


def told(demo: Demo, given: Iterable[Predicate] = ()) -> frozenset[Predicate]:
    """The predicates that need not be proposed: those ``given``, and what the demonstration's states and goal use."""
    of_states = (a.predicate for state in demo.states for a in state.given)
    return frozenset((*given, *of_states, *(affirmed(a).predicate for goal in demo.goals for a in goal)))


def read_words(
    demo: Demo, answer: str, settings: ProposalSettings, known_elsewhere: Iterable[Predicate] = ()
) -> Proposal:
    """The atoms that begin the lines of ``answer``, with their definitions; of two of one atom the first counts.

    Left out, with the reason, are words of predicates that are ``known_elsewhere``, and those whose meaning is a
    placeholder in every line of theirs.
    """
    known = frozenset(known_elsewhere)
    accepted: dict[ProposedAtom, None] = {}
    rejected: dict[Rejection, None] = {}
    hollow: list[tuple[str, ProposedAtom]] = []
    for line in clean(answer).splitlines():
        mention = next(mentions(line), None)
        if mention is None or any(character.isalnum() for character in line[: mention.start]):
            continue
        found = judged(demo, mention, settings, accepted)
        if isinstance(found, Rejection):
            rejected[found] = None
        elif same := next((p for p in known if _names(p, found)), None):
            rejected[Rejection(str(mention), f"{same.name} is known from elsewhere")] = None
        else:
            definition = read_definition(line[mention.end :])
            if is_placeholder(definition.meaning):
                hollow.append((str(mention), found))
            else:
                accepted.setdefault(replace(found, definition=definition))
    meant = {atom.name for atom in accepted}
    for text, atom in hollow:
        if atom.name in meant:  # another line says what the word means
            accepted.setdefault(atom)
        else:
            rejected[Rejection(text, "its meaning is a placeholder")] = None
    return Proposal(demo.name, tuple(accepted), tuple(rejected))


def _names(predicate: Predicate, atom: ProposedAtom) -> bool:
    """Whether ``atom`` is one of ``predicate`` but for the spelling of its name."""
    source = predicate.source
    words = {predicate.name, source.phrase} if isinstance(source, FromVLM) else {predicate.name}
    fits = len(atom.objects) == predicate.arity and all(
        o.type.is_a(t) for o, t in zip(atom.objects, predicate.types, strict=True)
    )
    return fits and _spelled(atom.name) in map(_spelled, words)


def _spelled(word: str) -> str:
    return word.replace("_", "").lower()
