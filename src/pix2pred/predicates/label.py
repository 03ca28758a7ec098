"""Asking a model for the truth of atoms, state by state (method 3): demonstrations and test states alike."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from pix2pred.images import skill_crop
from pix2pred.predicates.parse_labels import ParsedLabels, parse_labels, value_lines
from pix2pred.predicates.prompt import action_text, atom_text, fill, object_lines, views
from pix2pred.structs import FALSE, Action, Atom, Demo, Object, State
from pix2pred.structs.views import View
from pix2pred.vlm import VLM, Request

READ = "answers read"
"""Key of the count of answers that gave at least one value."""

TOKENS_PER_ATOM = 64
TOKENS_OF_REASONING = 1024


class LabelSettings(BaseModel):
    """How states are labelled."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    style: Literal["cot", "terse"] = Field("cot", description="explanations in the first state, or none")
    double_check: bool = Field(True, description="second query after t = 0, in training only")
    crops: bool = Field(True, description="also show the part of the scene the skill was about, before and after")
    marks: bool = Field(True, description="write object names into the pictures (simulation: yes, photos: no)")
    missing: Literal["carry_previous", "false"] = Field(
        "carry_previous", description="value of an atom the answer leaves out after t = 0 (at t = 0: false)"
    )
    max_atoms_per_query: int | None = Field(None, ge=1, description="split longer lists of atoms")
    attempts: int = Field(3, ge=1, description="queries before an answer without any value is given up")
    hints: tuple[str, ...] = Field((), description="sentences about the domain added to later-state queries")


@dataclass(frozen=True, slots=True)
class StateLabels:
    """Values of the queried atoms in one state and the answer text they were read from.

    ``unusable`` is the last answer when it held no value; ``text`` then lists the values carried over.
    """

    values: dict[Atom, int]
    text: str
    counts: Counter[str] = field(default_factory=Counter)
    unusable: str = ""


class UnusableAnswersError(RuntimeError):
    """A model whose answers hold no label at all: taking them for False would invent a world."""

    @classmethod
    def after(cls, model: str, labels: Sequence[StateLabels]) -> UnusableAnswersError:
        """The error for ``labels``, with their number and the first answer."""
        answers = [" ".join(s.unusable.split()) for s in labels if s.counts["unusable answers"]]
        example = f"; the first answer begins {answers[0][:120]!r}" if answers and answers[0] else "; they are empty"
        return cls(f"{model} gave unusable answers about {len(answers)} states, without a single label{example}")


@dataclass(frozen=True, slots=True)
class Labeller:
    """Labels states with one model."""

    vlm: VLM
    settings: LabelSettings

    def demo(self, demo: Demo, atoms: Sequence[Atom]) -> tuple[StateLabels, ...]:
        """Labels of all states of a demonstration, strictly in order: each query builds on the answer before."""
        labels = [self.first(demo.states[0], demo.objects, atoms)]
        for t, action in enumerate(demo.actions, start=1):
            before, after = demo.states[t - 1], demo.states[t]
            labels.append(
                self.next(
                    before, after, t, action, demo.objects, labels[-1], atoms, double_check=self.settings.double_check
                )
            )
        return tuple(labels)

    def first(self, state: State, objects: Sequence[Object], atoms: Sequence[Atom]) -> StateLabels:
        """Labels of a state without history (method 3.3); ``atoms`` in any order."""
        template = "label_first" if self.settings.style == "cot" else "label_first_terse"
        pictures = views(state, 0, objects, marks=self.settings.marks)
        parts = []
        for batch in self._batches(atoms):
            text = fill(template, objects=object_lines(objects), atoms="\n".join(map(atom_text, batch)))
            parts.append(self._ask("label", (text, *pictures), batch, carried={}))
        return _merged(parts)

    def next(
        self,
        before: State,
        after: State,
        t: int,
        action: Action,
        objects: Sequence[Object],
        previous: StateLabels,
        atoms: Sequence[Atom],
        *,
        double_check: bool,
    ) -> StateLabels:
        """Labels of the state after ``action`` (method 3.4), given the labels of the one before."""
        pictures = self._before_and_after(before, after, t, action, objects)
        crops = sum(view.crop is not None for view in pictures)
        carried = previous.values if self.settings.missing == "carry_previous" else {}
        parts = []
        for batch in self._batches(atoms):
            listed = "\n".join(map(atom_text, batch))
            question = fill(
                "label_next",
                action=action_text(action),
                objects=object_lines(objects),
                previous=previous.text,
                crops=f" {crops} of them show only the part of the scene the skill was about." if crops else "",
                hints="".join(f"{hint}\n" for hint in self.settings.hints),
                atoms=listed,
            )
            labels = self._ask("label", (question, *pictures), batch, carried)
            if double_check:
                values = value_lines({atom_text(a): previous.values[a] for a in batch if a in previous.values})
                check = fill("double_check", question=question, answer=labels.text, values=values, atoms=listed)
                first = labels.values if self.settings.missing == "carry_previous" else {}
                checked = self._ask("double-check", (check, *pictures), batch, first)
                labels = StateLabels(checked.values, checked.text, labels.counts + checked.counts)
            parts.append(labels)
        return _merged(parts)

    def _batches(self, atoms: Sequence[Atom]) -> list[list[Atom]]:
        ordered = sorted(atoms, key=atom_text)
        size = self.settings.max_atoms_per_query or max(1, len(ordered))
        return [ordered[i : i + size] for i in range(0, len(ordered), size)]

    def _before_and_after(
        self, before: State, after: State, t: int, action: Action, objects: Sequence[Object]
    ) -> tuple[View, ...]:
        full = (
            *views(before, t - 1, objects, marks=self.settings.marks, label="before"),
            *views(after, t, objects, marks=self.settings.marks, label="after"),
        )
        return (*full, *self._crops(before, after, action, full)) if self.settings.crops else full

    def _crops(self, before: State, after: State, action: Action, full: Sequence[View]) -> list[View]:
        names = [o.name for o in action.objects]
        cropped = []
        for camera, picture in enumerate(after.pictures):
            box = skill_crop(before, after, names, camera, picture.image.size)
            for view in full:
                if box and view.picture.camera == picture.camera:
                    heading = f"{view.heading}, around the skill"
                    cropped.append(View(view.picture, view.state, box, view.marks, heading))
        return cropped

    def _ask(
        self, purpose: str, parts: tuple[str | View, ...], batch: Sequence[Atom], carried: Mapping[Atom, int]
    ) -> StateLabels:
        """Query until an answer gives some value, at most ``attempts`` times; atoms left out keep ``carried``."""
        texts = {a: atom_text(a) for a in batch}
        queried = list(dict.fromkeys(texts.values()))
        budget = TOKENS_OF_REASONING + TOKENS_PER_ATOM * len(queried)
        counts: Counter[str] = Counter()
        parsed = ParsedLabels({}, tuple(queried), 0, 0)
        answer = ""
        for attempt in range(self.settings.attempts if batch else 0):
            answer = self.vlm.answer(Request(purpose, parts, budget, attempt=attempt)).text
            parsed = parse_labels(answer, queried)
            counts["other words"] += parsed.other_words
            counts["unasked"] += parsed.unasked
            counts[READ if parsed.values else "unusable answers"] += 1
            if parsed.values:
                break
        counts["missing"] += len(parsed.missing)
        values = {a: parsed.values.get(text, carried.get(a, FALSE)) for a, text in texts.items()}
        usable = answer if parsed.values else value_lines({texts[a]: value for a, value in values.items()})
        return StateLabels(values, usable, counts, "" if parsed.values else answer)


def _merged(parts: Sequence[StateLabels]) -> StateLabels:
    values: dict[Atom, int] = {}
    counts: Counter[str] = Counter()
    for part in parts:
        values |= part.values
        counts += part.counts
    return StateLabels(values, "\n\n".join(p.text for p in parts), counts, "".join(p.unusable for p in parts))
