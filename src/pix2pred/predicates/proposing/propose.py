"""Asking a model for predicates and lifting what it proposes into a pool (method 2)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from pix2pred.predicates.prompt import action_text, fill, object_lines, views
from pix2pred.predicates.proposing.parse_atoms import clean, mentions
from pix2pred.structs import Candidate, Demo, FromVLM, Object, Predicate, Type
from pix2pred.structs.views import LONGEST_SIDE
from pix2pred.system.errors import Pix2predError
from pix2pred.system.progress import Progress, Stage, silent
from pix2pred.vlm import VLM, Finish, NoAnswerError, Purpose, Request, Review, Together

ANSWER_TOKENS = 8192
"""Budget of a proposal: a model lists hundreds of atoms."""


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


@dataclass(frozen=True, slots=True)
class ProposedAtom:
    """An accepted atom, in the words of the model and over the demonstration's objects."""

    name: str
    objects: tuple[Object, ...]


@dataclass(frozen=True, slots=True)
class Rejection:
    """A proposed atom that was not used, and why."""

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


def propose(
    demos: Sequence[Demo],
    vlm: VLM,
    settings: ProposalSettings,
    *,
    together: Together | None = None,
    progress: Progress = silent,
) -> tuple[Proposal, ...]:
    """One proposal per demonstration, in the order of ``demos``, asked for as ``together`` allows.

    Raises ``EmptyProposalError`` if all are empty.
    """
    asking = together or Together()
    proposals: list[Proposal] = []
    for proposal in asking.map(lambda demo: _propose_for(demo, vlm, settings), demos):
        proposals.append(proposal)
        progress(Stage.PROPOSE, len(proposals), len(demos), proposal.demo)
    if not any(p.accepted for p in proposals):
        first = next((f" ({p.demo}: {p.problem})" for p in proposals if p.problem), "")
        raise EmptyProposalError(
            f"{vlm.name} proposed no usable predicate for any of {len(demos)} demonstrations{first}; "
            "see the rejected atoms in the run folder (proposals.json)",
            tuple(proposals),
        )
    return tuple(proposals)


def _propose_for(demo: Demo, vlm: VLM, settings: ProposalSettings) -> Proposal:
    proposal, budget = Proposal(demo.name, (), ()), ANSWER_TOKENS
    for attempt in range(settings.attempts):
        try:
            answer = vlm.answer(proposal_request(demo, settings, attempt, budget))
        except NoAnswerError as error:
            return replace(proposal, problem=f"no answer: {error}")
        read = read_proposal(demo, answer.text, settings)
        if answer.finish == Finish.REFUSED:
            proposal = replace(proposal, problem=proposal.problem or "refused")
        elif answer.finish == Finish.TOO_LARGE:
            budget //= 2
            proposal = replace(proposal, problem="the model never allowed an answer of the length asked for")
        elif answer.finish == Finish.CUT_SHORT:
            budget *= 2
            proposal = replace(_whole_lines(demo, answer.text, settings), problem="the answer was always cut short")
        elif read.accepted:
            return read
        else:
            proposal = read if not proposal.accepted else proposal
    return proposal


def _whole_lines(demo: Demo, answer: str, settings: ProposalSettings) -> Proposal:
    """What was read from an answer that broke off, without its last line."""
    return read_proposal(demo, answer.rpartition("\n")[0], settings)


def proposal_request(demo: Demo, settings: ProposalSettings, attempt: int = 0, budget: int = ANSWER_TOKENS) -> Request:
    """The query about one demonstration: instruction, objects, actions, then every state's pictures."""
    limit = "Propose only {} to {} predicates.\n".format(*settings.asked) if settings.asked else ""
    limit += f"List at most {settings.max_atoms} predicates in total.\n" if settings.max_atoms else ""
    text = fill(
        "propose" if settings.variant == "diverse" else "propose_specific",
        objects=object_lines(demo.objects),
        actions="\n".join(f"{t}. {action_text(a)}" for t, a in enumerate(demo.actions)),
        limit=limit,
    )
    size, marks = settings.longest_side, settings.marks
    shown = (views(s, t, demo.objects, marks=marks, longest_side=size) for t, s in enumerate(demo.states))
    return Request(
        Purpose.PROPOSE,
        (text, *chain.from_iterable(shown)),
        budget,
        attempt=attempt,
        about=demo.name,
        review=lambda answer: _review(read_proposal(demo, answer, settings)),
    )


def _review(proposal: Proposal) -> Review | None:
    if proposal.accepted:
        return None
    why = "; ".join(f"{r.text}: {r.reason}" for r in proposal.rejected[:3])
    return Review(f"No predicate of the form name(object1, object2) could be used. {why}".strip(), usable=False)


def read_proposal(demo: Demo, answer: str, settings: ProposalSettings) -> Proposal:
    """Parse an answer and filter it as section 2.3 says, keeping the reason for everything left out."""
    known = {o.name: o for o in demo.objects} | {o.prompt_name: o for o in demo.objects}
    accepted: dict[ProposedAtom, None] = {}
    rejected: dict[Rejection, None] = {}
    for mention in mentions(clean(answer)):
        reason = None
        unknown = [a for a in mention.args if a not in known]
        objects = tuple(known[a] for a in mention.args if a in known)
        atom = ProposedAtom(mention.name, objects)
        if unknown:
            reason = f"{unknown[0]} is not an object of this demonstration"
        elif word := _excluded(mention.name, mention.args, settings.exclude):
            reason = f"mentions the excluded word {word}"
        elif len(set(objects)) < len(objects):
            reason = "names one object twice"
        elif atom not in accepted and settings.max_atoms and len(accepted) >= settings.max_atoms:
            reason = f"over the limit of {settings.max_atoms} atoms"
        if reason:
            rejected[Rejection(str(mention), reason)] = None
        else:
            accepted[atom] = None
    return Proposal(demo.name, tuple(accepted), tuple(rejected))


def _excluded(name: str, args: Iterable[str], exclude: Iterable[str]) -> str | None:
    words = {part for text in (name, *args) for part in re.split(r"_|(?<=[a-z])(?=[A-Z])|\d+", text) if part}
    mentioned = {word.lower() for word in words}
    return next((word for word in exclude if word.lower() in mentioned), None)


def lift(proposals: Iterable[Proposal], taken: Iterable[str] = ()) -> tuple[Candidate, ...]:
    """The pool: one predicate per distinct (name, object types), numbered per name (method 2.4, 2.5).

    ``taken`` are names already in use. A visual predicate costs its arity (4.5).
    """
    signatures: dict[str, set[tuple[Type, ...]]] = {}
    for proposal in proposals:
        for atom in proposal.accepted:
            signatures.setdefault(atom.name, set()).add(tuple(o.type for o in atom.objects))
    used = set(taken)
    pool = []
    for base in sorted(signatures):
        for i, types in enumerate(sorted(signatures[base], key=lambda ts: [t.name for t in ts])):
            name = f"{base}{i}"
            while name in used:
                name = f"{base}_{i}" if name == f"{base}{i}" else name + "_"
            used.add(name)
            pool.append(Candidate(Predicate(name, types, FromVLM(base)), float(len(types))))
    return tuple(sorted(pool))
