"""Asking a model for predicates (method 2)."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from math import prod
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from pix2pred.predicates.frugal.definitions import Definition
from pix2pred.predicates.prompt import action_text, fill, object_lines, views
from pix2pred.predicates.proposing.parse_atoms import LONGEST_NAME, SHOWN, Mention, clean, mentions
from pix2pred.structs import Demo, Object
from pix2pred.structs.views import LONGEST_SIDE
from pix2pred.system.errors import Pix2predError
from pix2pred.system.progress import Progress, Stage, silent
from pix2pred.vlm import VLM, Finish, NoAnswerError, Purpose, Request, Review, Together
from pix2pred.vlm.request import Part

ANSWER_TOKENS = 8192
"""Budget of a proposal: a model lists hundreds of atoms."""
MOST_GROUNDINGS = 2000
"""Atoms of one state that a proposed predicate of many places may have: twenty questions of a hundred atoms."""
PLACES_OF_ANY_SIZE = 2
"""Predicates of so few places are taken however many objects there are; ``flow.max_atoms`` bounds them all together."""


class ProposalSettings(BaseModel):
    """How predicates are asked for and filtered."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    variant: Literal["diverse", "specific"] = "diverse"
    asked: tuple[int, int] | None = Field(
        None, description="how many predicates the model is asked for, not held to (Coffee: 5 to 10)"
    )
    max_atoms: int | None = Field(None, ge=1, description="atoms kept per demonstration (Cleanup, Juice: 25)")
    exclude: tuple[str, ...] = Field((), description="words; atoms that mention one are dropped (e.g. hand, gripper)")
    marks: bool = Field(True, description="write object names into the pictures (simulation: yes, photos: no)")
    longest_side: int = Field(LONGEST_SIDE, ge=64, le=4096, description="pixels, of a shown picture (paper: 512)")
    attempts: int = Field(3, ge=1, description="queries per demonstration before giving up on an unusable answer")

    @property
    def diverse(self) -> bool:
        """Whether many different predicates are asked for, and not only the few that seem to matter."""
        return self.variant == "diverse"


@dataclass(frozen=True, slots=True)
class ProposedAtom:
    """An accepted atom, in the words of the model and over the demonstration's objects.

    ``definition`` is what the model says it means, where it was asked for that.
    """

    name: str
    objects: tuple[Object, ...]
    definition: Definition | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Rejection:
    """Something proposed that is not used.

    ``text`` is as the model wrote it, ``reason`` says for people what is wrong with it.
    """

    text: str
    reason: str


@dataclass(frozen=True, slots=True)
class Proposal:
    """What came of asking about one demonstration; ``problem`` says why no whole answer was to be had."""

    demo: str
    accepted: tuple[ProposedAtom, ...]
    rejected: tuple[Rejection, ...]
    problem: str = ""


class EmptyProposalError(Pix2predError, RuntimeError):
    """No demonstration gave a single usable atom; ``proposals`` tell what was rejected and why."""

    def __init__(self, message: str, proposals: tuple[Proposal, ...]) -> None:
        super().__init__(message)
        self.proposals = proposals


class TooManyPicturesError(Pix2predError, ValueError):
    """A question that cannot be asked with as few pictures as a server takes."""


def propose(
    demos: Sequence[Demo],
    vlm: VLM,
    settings: ProposalSettings,
    *,
    together: Together | None = None,
    max_pictures: int | None = None,
    progress: Progress = silent,
) -> tuple[Proposal, ...]:
    """One proposal per demonstration, in the order of ``demos``, asked for as ``together`` allows.

    A demonstration of more than ``max_pictures`` pictures is asked about in parts. Raises ``EmptyProposalError`` if all
    are empty, and ``TooManyPicturesError`` for a state of more pictures than that.
    """
    asking = together or Together()
    proposals: list[Proposal] = []
    for proposal in asking.map(lambda demo: _propose_for(demo, vlm, settings, max_pictures), demos):
        proposals.append(proposal)
        progress(Stage.PROPOSE, len(proposals), len(demos), proposal.demo)
    return refuse_empty(vlm, proposals)


def refuse_empty(vlm: VLM, proposals: Sequence[Proposal]) -> tuple[Proposal, ...]:
    """``proposals``; raises ``EmptyProposalError`` if none of them holds a usable atom."""
    if not any(p.accepted for p in proposals):
        first = next((f" ({p.demo}: {p.problem})" for p in proposals if p.problem), "")
        raise EmptyProposalError(
            f"{vlm.name} proposed no usable predicate for any of {len(proposals)} demonstrations{first}; "
            "see the rejected atoms in the run folder (proposals.json)",
            tuple(proposals),
        )
    return tuple(proposals)


def _propose_for(demo: Demo, vlm: VLM, settings: ProposalSettings, max_pictures: int | None) -> Proposal:
    """What the model proposes for a demonstration, or for all of its parts together."""

    def about(part: range) -> Proposal:
        return answered_proposal(
            demo.name,
            vlm,
            lambda attempt, budget: proposal_request(demo, settings, attempt, budget, part),
            lambda answer: read_proposal(demo, answer, settings),
            settings.attempts,
        )

    parts = [about(part) for part in parts_of(demo, max_pictures)]
    atoms = tuple(dict.fromkeys(atom for part in parts for atom in part.accepted))[: settings.max_atoms]
    rejected = tuple(dict.fromkeys(r for part in parts for r in part.rejected))
    return Proposal(demo.name, atoms, rejected, next((p.problem for p in parts if p.problem), ""))


def parts_of(demo: Demo, max_pictures: int | None) -> Iterator[range]:
    """The states of a demonstration in runs of at most ``max_pictures`` pictures; each begins where one ended.

    Raises ``TooManyPicturesError`` when the pictures before and after one skill are more than that.
    """
    pictures = max((len(s.pictures) for s in demo.states), default=0)
    if max_pictures is None or pictures * len(demo.states) <= max_pictures:
        yield range(len(demo.states))
        return
    size = max_pictures // pictures
    if size < 2:
        raise TooManyPicturesError(
            f"{demo.name}: states before and after a skill have {2 * pictures} pictures, and 'flow: {{max_pictures: "
            f"{max_pictures}}}' allows {max_pictures}; leave cameras out, or let the server take more"
        )
    for first in range(0, len(demo.states) - 1, size - 1):
        yield range(first, min(first + size, len(demo.states)))


def answered_proposal(
    demo: str, vlm: VLM, request: Callable[[int, int], Request], read: Callable[[str], Proposal], attempts: int
) -> Proposal:
    """What came of asking about the demonstration called ``demo``, at most ``attempts`` times.

    ``request`` makes the question from the number of the attempt and the answer's token budget, which grows when an
    answer was cut short and shrinks when the model does not allow it; ``read`` reads an answer.
    """
    proposal, budget = Proposal(demo, (), ()), ANSWER_TOKENS
    for attempt in range(attempts):
        try:
            answer = vlm.answer(request(attempt, budget))
        except NoAnswerError as error:
            return replace(proposal, problem=f"no answer: {error}")
        found = read(answer.text)
        if answer.finish == Finish.REFUSED:
            proposal = replace(proposal, problem=proposal.problem or "refused")
        elif answer.finish == Finish.TOO_LARGE:
            budget //= 2
            proposal = replace(proposal, problem="the model never allowed an answer of the length asked for")
        elif answer.finish == Finish.CUT_SHORT:
            budget *= 2
            proposal = replace(read(answer.text.rpartition("\n")[0]), problem="the answer was always cut short")
        elif found.accepted:
            return found
        else:
            proposal = found if not proposal.accepted else proposal
    return proposal


def proposal_request(
    demo: Demo, settings: ProposalSettings, attempt: int = 0, budget: int = ANSWER_TOKENS, part: range | None = None
) -> Request:
    """The query about one demonstration, or the states ``part`` of it: instruction, objects, actions, pictures."""
    times = range(len(demo.states)) if part is None else part
    text = fill(
        "propose" if settings.diverse else "propose_specific",
        objects=object_lines(demo.objects),
        actions="\n".join(f"{t}. {action_text(demo.actions[t])}" for t in times[:-1]),
        limit=limit_text(settings),
    )
    request = about_demo(Purpose.PROPOSE, text, demo, times, settings, lambda a: read_proposal(demo, a, settings))
    return replace(request, attempt=attempt, max_tokens=budget)


def about_demo(
    purpose: Purpose,
    text: str,
    demo: Demo,
    times: Iterable[int],
    settings: ProposalSettings,
    read: Callable[[str], Proposal],
    *,
    number_skills: bool = False,
) -> Request:
    """A question with the pictures of the states ``times`` of a demonstration; ``read`` reads its answer.

    ``number_skills``: headings say after which skill a state was.
    """
    size, marks = settings.longest_side, settings.marks
    shown = (
        views(
            demo.states[t], t, demo.objects, marks=marks, longest_side=size,
            after=t - 1 if number_skills and t else None,
        )
        for t in times
    )  # fmt: skip
    parts: tuple[Part, ...] = (text, *chain.from_iterable(shown))
    name = demo.name
    return Request(purpose, parts, ANSWER_TOKENS, about=name, demo=name, review=lambda answer: review(read(answer)))


def limit_text(settings: ProposalSettings) -> str:
    """The sentences that say how many predicates are asked for; empty without such a setting."""
    limit = "Propose only {} to {} predicates.\n".format(*settings.asked) if settings.asked else ""
    return limit + (f"List at most {settings.max_atoms} predicates in total.\n" if settings.max_atoms else "")


def review(proposal: Proposal) -> Review | None:
    """What is wrong with the answer that ``proposal`` was read from."""
    if proposal.accepted:
        return None
    why = "; ".join(f"{r.text}: {r.reason}" for r in proposal.rejected[:3])
    return Review(f"No predicate of the form name(object1, object2) could be used. {why}".strip(), usable=False)


def read_proposal(demo: Demo, answer: str, settings: ProposalSettings) -> Proposal:
    """Parse an answer and filter it as section 2.3 says, keeping the reason for everything left out."""
    accepted: dict[ProposedAtom, None] = {}
    rejected: dict[Rejection, None] = {}
    for mention in mentions(clean(answer)):
        found = judged(demo, mention, settings, accepted)
        if isinstance(found, Rejection):
            rejected[found] = None
        else:
            accepted[found] = None
    said = "" if accepted or rejected or not answer else f"no atom in the answer: {' '.join(answer.split())[:SHOWN]}"
    return Proposal(demo.name, tuple(accepted), tuple(rejected), said)


def judged(
    demo: Demo, mention: Mention, settings: ProposalSettings, accepted: Collection[ProposedAtom]
) -> ProposedAtom | Rejection:
    """The atom that ``mention`` writes, or why it is not used (method 2.3); ``accepted`` are those taken already."""
    if (longest := len(max(mention.name, *mention.args, key=len))) > LONGEST_NAME:
        return Rejection(f"{str(mention)[:LONGEST_NAME]}…", f"holds a name of {longest:,} characters")
    known = {o.name: o for o in demo.objects} | {o.prompt_name: o for o in demo.objects}
    unknown = [a for a in mention.args if a not in known]
    objects = tuple(known[a] for a in mention.args if a in known)
    atom = ProposedAtom(mention.name, objects)
    if unknown:
        return Rejection(str(mention), f"{unknown[0]} is not an object of this demonstration")
    if word := _excluded(mention.name, mention.args, settings.exclude):
        return Rejection(str(mention), f"mentions the excluded word {word}")
    if len(set(objects)) < len(objects):
        return Rejection(str(mention), "names one object twice")
    if (count := _groundings(demo, objects)) > MOST_GROUNDINGS and len(objects) > PLACES_OF_ANY_SIZE:
        return Rejection(str(mention), f"has {len(objects)} places, which makes {count:,} atoms of this demonstration")
    if atom not in accepted and settings.max_atoms and len(accepted) >= settings.max_atoms:
        return Rejection(str(mention), f"over the limit of {settings.max_atoms} atoms")
    return atom


def _groundings(demo: Demo, objects: Sequence[Object]) -> int:
    """How many atoms the predicate has over the objects of ``demo``, one object in two places included."""
    return prod(sum(o.type.is_a(place.type) for o in demo.objects) for place in objects)


def _excluded(name: str, args: Iterable[str], exclude: Iterable[str]) -> str | None:
    parts = (part for text in (name, *args) for part in re.split(r"_|(?<=[a-z])(?=[A-Z])|\d+", text))
    mentioned = {part.lower() for part in parts}
    return next((word for word in exclude if word.lower() in mentioned), None)
