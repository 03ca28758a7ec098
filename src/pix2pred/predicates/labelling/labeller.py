"""Asking a model for the truth of atoms, state by state (method 3): demonstrations and test states alike."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from pix2pred.images import skill_crop
from pix2pred.predicates.labelling.asking import Asker, MakeQuestion, Occurrence, in_batches
from pix2pred.predicates.labelling.label_format import LabelFormat
from pix2pred.predicates.labelling.parse_labels import value_lines
from pix2pred.predicates.labelling.settings import LabelSettings
from pix2pred.predicates.labelling.state_labels import StateLabels, StepToLabel
from pix2pred.predicates.labelling.telling import Telling
from pix2pred.predicates.prompt import action_text, atom_text, fill, object_lines, views
from pix2pred.structs import Action, Atom, Demo, Label, Object, State
from pix2pred.structs.views import View
from pix2pred.vlm import VLM, Purpose, Together
from pix2pred.vlm.request import Part


@dataclass(frozen=True, slots=True)
class Labeller:
    """Labels states with one model; ``together`` bounds how many questions are under way at once."""

    vlm: VLM
    settings: LabelSettings
    together: Together = field(default_factory=Together)

    def asking(self, vlm: VLM) -> Labeller:
        return replace(self, vlm=vlm)

    def demo(self, demo: Demo, atoms: Sequence[Atom]) -> tuple[StateLabels, ...]:
        """Labels of all states of a demonstration, strictly in order: each query builds on the answer before."""
        objects, about = demo.objects, f"{demo.name}, state"
        steps = [
            StepToLabel(demo.states[t - 1], demo.states[t], t, action, StateLabels({}, ""), self.settings.double_check)
            for t, action in enumerate(demo.actions, start=1)
        ]
        after = [*(self._before_and_after(step, objects) for step in steps), ()]
        telling = [replace(self, vlm=Telling(self.vlm, demo.name, upcoming)) for upcoming in after]
        labels = [telling[0].first(demo.states[0], objects, atoms, about=f"{about} 0")]
        for step in steps:
            step, asking = replace(step, previous=labels[-1]), telling[step.t]
            labels.append(asking.next(step, objects, atoms, about=f"{about} {step.t}"))
        return tuple(labels)

    def first(self, state: State, objects: Sequence[Object], atoms: Sequence[Atom], about: str = "") -> StateLabels:
        """Labels of a state without history (method 3.3); ``atoms`` in any order."""
        template = "label_first" if self.settings.explains else "label_first_terse"
        pictures = self._views(state, 0, objects)

        def question(batch: Sequence[Atom]) -> tuple[Part, ...]:
            return (fill(template, objects=object_lines(objects), atoms=_listed(batch)), *pictures)

        asker = self._asker(Purpose.LABEL, question, about)
        return _merged(self._together(lambda batch: _labels(asker, batch, {}), atoms))

    def next(self, step: StepToLabel, objects: Sequence[Object], atoms: Sequence[Atom], about: str = "") -> StateLabels:
        """Labels of the state after an action (method 3.4), given the labels of the one before."""
        pictures = self._before_and_after(step, objects)
        crops = sum(view.crop is not None for view in pictures)
        previous = step.previous
        carried = self.settings.carried(previous.values)

        def text(batch: Sequence[Atom]) -> str:
            return fill(
                "label_next",
                action=action_text(step.action),
                objects=object_lines(objects),
                previous=previous.text,
                crops=f" {crops} of them show only the part of the scene the skill was about." if crops else "",
                hints="".join(f"{hint}\n" for hint in self.settings.hints),
                atoms=_listed(batch),
            )

        def labelled(batch: Sequence[Atom]) -> StateLabels:
            asker = self._asker(Purpose.LABEL, lambda part: (text(part), *pictures), about)
            labels = _labels(asker, batch, carried)
            if not step.double_check:
                return labels
            return self._checked(labels, batch, previous, text, pictures, about)

        return _merged(self._together(labelled, atoms))

    def _checked(
        self,
        labels: StateLabels,
        batch: Sequence[Atom],
        previous: StateLabels,
        text: Callable[[Sequence[Atom]], str],
        pictures: Sequence[View],
        about: str,
    ) -> StateLabels:
        """The labels after the double check (method 3.5): its answer replaces the first."""

        def question(part: Sequence[Atom]) -> tuple[Part, ...]:
            before = value_lines({atom_text(a): previous.values[a] for a in part if a in previous.values})
            check = fill("double_check", question=text(part), answer=labels.text, values=before, atoms=_listed(part))
            return (check, *pictures)

        carried = self.settings.carried(labels.values)
        checked = _labels(self._asker(Purpose.DOUBLE_CHECK, question, about), batch, carried)
        confidence = {a: labels.confidence[a] for a in labels.confidence if a not in checked.confidence}
        confidence = {a: p for a, p in confidence.items() if checked.values[a] == labels.values[a]}
        open_atoms = {t for gap in checked.gaps for t in gap.atoms}
        left = [replace(g, atoms=tuple(t for t in g.atoms if t in open_atoms)) for g in labels.gaps]
        gaps = (*(g for g in left if g.atoms), *checked.gaps)
        return replace(
            checked, counts=labels.counts + checked.counts, confidence=confidence | checked.confidence, gaps=gaps
        )

    def _together(self, labelled: Callable[[Sequence[Atom]], StateLabels], atoms: Sequence[Atom]) -> list[StateLabels]:
        """The labels of all batches, asked for at the same time."""
        return list(self.together.map(labelled, in_batches(atoms, self.settings.max_atoms_per_query)))

    def _asker(self, purpose: Purpose, question: MakeQuestion, about: str) -> Asker[Label]:
        form = LabelFormat(self.settings.structured)
        return Asker(self.vlm, self.settings, form, self.together, purpose, question, about)

    def _before_and_after(self, step: StepToLabel, objects: Sequence[Object]) -> tuple[View, ...]:
        full = (
            *self._views(step.before, step.t - 1, objects, "before"),
            *self._views(step.after, step.t, objects, "after"),
        )
        return (*full, *self._crops(step.before, step.after, step.action, full)) if self.settings.crops else full

    def _views(self, state: State, t: int, objects: Sequence[Object], label: str = "") -> tuple[View, ...]:
        settings = self.settings
        return views(state, t, objects, marks=settings.marks, longest_side=settings.longest_side, label=label)

    def _crops(self, before: State, after: State, action: Action, full: Sequence[View]) -> list[View]:
        names = [o.name for o in action.objects]
        cropped = []
        for camera, picture in enumerate(after.pictures):
            box = skill_crop(before, after, names, camera, picture.image.size)
            for view in full:
                if box and view.picture.camera == picture.camera:
                    heading = f"{view.heading}, around the skill"
                    cropped.append(replace(view, crop=box, heading=heading))
        return cropped


def _listed(batch: Sequence[Atom]) -> str:
    return "\n".join(dict.fromkeys(map(atom_text, batch)))


def _labels(asker: Asker[Label], batch: Sequence[Atom], carried: Mapping[Atom, Label]) -> StateLabels:
    """Labels of a batch; atoms left without a value keep ``carried``, or else are false."""
    asked = asker.ask(batch)
    values = {a: asked.values.get(a, carried.get(a, Label.FALSE)) for a in batch}
    counts = asked.counts + Counter({Occurrence.MISSING: len(values) - len(asked.values)})
    text = "\n\n".join(asked.texts) or value_lines({atom_text(a): value for a, value in values.items()})
    return StateLabels(values, text, counts, "" if asked.values else asked.useless, asked.confidence, asker.gaps(asked))


def _merged(parts: Sequence[StateLabels]) -> StateLabels:
    """The labels of all batches of one state."""
    values: dict[Atom, Label] = {}
    confidence: dict[Atom, float] = {}
    for part in parts:
        values |= part.values
        confidence |= part.confidence
    return StateLabels(
        values,
        "\n\n".join(p.text for p in parts),
        sum((p.counts for p in parts), Counter[Occurrence]()),
        "".join(p.unusable for p in parts),
        confidence,
        tuple(gap for p in parts for gap in p.gaps),
    )
