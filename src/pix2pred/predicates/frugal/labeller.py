"""Labels of many states in one question, at a fraction of the price of asking state by state."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from pix2pred.images import skill_crop
from pix2pred.predicates.frugal.definitions import meanings_of, skill_lines
from pix2pred.predicates.frugal.histories import History, HistoryFormat
from pix2pred.predicates.labelling.asking import Asked, Asker, Occurrence, in_batches
from pix2pred.predicates.labelling.parse_labels import value_lines
from pix2pred.predicates.labelling.settings import LabelSettings
from pix2pred.predicates.labelling.state_labels import StateLabels, StepToLabel
from pix2pred.predicates.labelling.telling import Telling
from pix2pred.predicates.prompt import action_text, atom_text, fill, kind_lines, object_lines, views
from pix2pred.structs import Action, Atom, Demo, FromVLM, Label, Object, State
from pix2pred.structs.views import View
from pix2pred.vlm import VLM, Purpose, Together
from pix2pred.vlm.request import Part

CROP_SCALE = 2
"""A crop's longer side is this many times shorter than a picture's, and so cheaper."""

LEAST_ZOOM = 1.5
"""A crop around a skill that shows things less enlarged than this is left out: the whole picture shows them as well."""

WORD_MARK = "~"
"""Stands in the name of a predicate asked in another word, before that word."""

TWICE = (
    "\nSome of them mean the same as another one, or its contrary, as the meanings say; this is meant so. Look at the "
    "picture anew for each, so that a slip shows."
)

ALL_OTHERS_FALSE = "All other predicates below: False"
"""Ends the values of an earlier state where only what is not false is named: most is false, and is listed below."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """Successive states that one question shows; ``start`` numbers the first, ``actions`` lie between them.

    ``objects`` are those of the scene, ``known`` the labels of the first state where it has been labelled, and
    ``about`` names the states for people.
    """

    states: tuple[State, ...]
    actions: tuple[Action, ...]
    start: int
    objects: Sequence[Object]
    about: str
    known: Mapping[Atom, Label] = field(default_factory=dict)

    @property
    def numbers(self) -> tuple[int, ...]:
        """The numbers of the states."""
        return tuple(range(self.start, self.start + len(self.states)))


@dataclass(frozen=True, slots=True)
class FrugalLabeller:
    """Labels states with one model; ``together`` bounds how many questions are under way at once.

    Questions about demonstrations show fewer states where these would be more than ``max_pictures``.
    """

    vlm: VLM
    settings: LabelSettings
    together: Together = field(default_factory=Together)
    max_pictures: int | None = None

    def asking(self, vlm: VLM) -> FrugalLabeller:
        return replace(self, vlm=vlm)

    def demo(self, demo: Demo, atoms: Sequence[Atom]) -> tuple[StateLabels, ...]:
        asking = replace(self, vlm=Telling(self.vlm, demo.name))
        labels: list[StateLabels] = []
        for stretch in self._stretches(demo):
            stretch = replace(stretch, known=labels[-1].values if labels else {})
            # a stretch begins with the last state of the one before, whose labels are there already
            labels += asking._labels(stretch, atoms)[1 if labels else 0 :]
        return tuple(labels)

    def first(self, state: State, objects: Sequence[Object], atoms: Sequence[Atom], about: str = "") -> StateLabels:
        return self._by_several_words(Stretch((state,), (), 0, objects, about), atoms)

    def next(self, step: StepToLabel, objects: Sequence[Object], atoms: Sequence[Atom], about: str = "") -> StateLabels:
        states, known = (step.before, step.after), step.previous.values
        return self._by_several_words(Stretch(states, (step.action,), step.t - 1, objects, about, known), atoms)

    def _stretches(self, demo: Demo) -> Iterator[Stretch]:
        size = self._states_shown(max((len(s.pictures) for s in demo.states), default=0))
        for start in range(0, max(1, len(demo.states) - 1), size - 1):
            end = min(start + size, len(demo.states))
            about = f"{demo.name}, states {start} to {end - 1}"
            states, actions = tuple(demo.states[start:end]), tuple(demo.actions[start : end - 1])
            yield Stretch(states, actions, start, demo.objects, about)

    def _states_shown(self, cameras: int) -> int:
        """States in one question. Two are the fewest; whether their pictures are too many is said when it is asked."""
        most = self.settings.states_per_query
        if self.max_pictures is None or not cameras:
            return most
        crops = cameras if self.settings.crops else 0  # for every state but the first
        return max(2, min(most, (self.max_pictures + crops) // (cameras + crops)))

    def _by_several_words(self, stretch: Stretch, atoms: Sequence[Atom]) -> StateLabels:
        """Labels of the last state of ``stretch``, each the majority over the words for its meaning.

        A plan rests on one look, and a model that reads one word wrongly rarely reads its synonyms and antonyms
        wrongly in the same picture.
        """
        words = {atom: _words(atom, self.settings.words_per_meaning) for atom in atoms}
        asked = [form for forms in words.values() for form, _ in forms]
        said = self._labels(stretch, asked)[-1]
        values = {
            atom: _majority([said.values[f].contrary if n else said.values[f] for f, n in forms])
            for atom, forms in words.items()
        }
        texts = {atom_text(atom) for atom in atoms}
        gaps = [replace(gap, atoms=tuple(t for t in gap.atoms if t in texts)) for gap in said.gaps]
        sure = {atom: said.confidence[atom] for atom in atoms if atom in said.confidence}
        return replace(said, values=values, confidence=sure, gaps=tuple(g for g in gaps if g.atoms))

    def _labels(self, stretch: Stretch, atoms: Sequence[Atom]) -> list[StateLabels]:
        """Labels of every state of ``stretch``."""
        pictures = self._pictures(stretch)

        def question(part: Sequence[Atom]) -> tuple[Part, ...]:
            return (self._text(stretch, part, pictures), *pictures)

        form = HistoryFormat(stretch.numbers)
        asker = Asker(self.vlm, self.settings, form, self.together, Purpose.HISTORY, question, stretch.about)
        asked = Asked[History]()
        for one in self.together.map(asker.ask, in_batches(atoms, self.settings.max_atoms_per_query)):
            asked.merge(one)
        carried = self.settings.carried(stretch.known)
        without = {a: (carried.get(a, Label.FALSE),) * len(stretch.states) for a in atoms}
        histories = without | asked.values
        counts = asked.counts + Counter({Occurrence.MISSING: len(atoms) - len(asked.values)})
        labels = [
            StateLabels({a: h[i] for a, h in histories.items()}, "", Counter(), "", dict(asked.confidence))
            for i in range(len(stretch.states))
        ]
        text, useless = "\n\n".join(asked.texts), "" if asked.values else asked.useless
        # one answer speaks of all states; it is counted, and kept, with the last, which is new in every stretch
        labels[-1] = replace(labels[-1], text=text, counts=counts, unusable=useless, gaps=asker.gaps(asked))
        return labels

    def _text(self, stretch: Stretch, atoms: Sequence[Atom], pictures: Sequence[View]) -> str:
        """The question. What is the same for all demonstrations stands first, so that providers' prompt caches hit."""
        crops = sum(view.crop is not None for view in pictures)
        known = stretch.known
        before = _before({atom_text(a): known.get(a) for a in sorted(atoms, key=atom_text)})
        actions = [f"{t}. {action_text(a)}" for t, a in enumerate(stretch.actions, start=stretch.start)]
        # a skill that nobody described would only stand here as it stands among the executed ones
        skills = skill_lines(a.skill for a in stretch.actions if a.skill.description)
        number = f"number {stretch.start} leads from state {stretch.start} to state {stretch.start + 1}, and so on"
        return fill(
            "frugal_label",
            meanings=meanings_of(atoms),
            skills=f"\nSkills of the robot:\n{skills}\n" if skills else "\n" if self.settings.hints else "",
            hints="".join(f"{hint}\n" for hint in self.settings.hints),
            objects=object_lines(stretch.objects),
            kinds=kind_lines(stretch.objects),
            actions="\n".join(["", "Executed skills:", f"({number})", *actions, ""]) if actions else "",
            twice=TWICE if any(WORD_MARK in a.predicate.name for a in atoms) else "",
            crops=f"{crops} of the pictures show only the part of the scene a skill was about.\n" if crops else "",
            previous=f"Values in state {stretch.start}, as answered earlier:\n<previous>\n{before}\n</previous>\n"
            if before
            else "",
            atoms="\n".join(dict.fromkeys(map(atom_text, atoms))),
        )

    def _pictures(self, stretch: Stretch) -> list[View]:
        settings, shown = self.settings, list[View]()
        for i, (t, state) in enumerate(zip(stretch.numbers, stretch.states, strict=True)):
            side, after = settings.longest_side, t - 1 if i else None
            whole = views(state, t, stretch.objects, marks=settings.marks, longest_side=side, after=after)
            shown += whole
            if i and settings.crops:
                shown += self._crops(stretch.states[i - 1], state, stretch.actions[i - 1], whole)
        return shown

    def _crops(self, before: State, after: State, action: Action, whole: Sequence[View]) -> Iterator[View]:
        names, smaller = [o.name for o in action.objects], self.settings.longest_side // CROP_SCALE
        for camera, view in enumerate(whole):
            width, height = view.picture.image.size
            box = skill_crop(before, after, names, camera, (width, height))
            if box and max(width, height) >= LEAST_ZOOM * CROP_SCALE * max(box.width, box.height):
                heading = f"{view.heading}, around the skill"
                yield replace(view, crop=box, heading=heading, longest_side=smaller)


def _before(known: Mapping[str, Label | None]) -> str:
    """The values of the state before, one a line; where all are known, what is false is not named one by one."""
    said = {atom: label for atom, label in known.items() if label is not None}
    if len(said) < len(known) or not said:
        return value_lines(said)
    others = {atom: label for atom, label in said.items() if label is not Label.FALSE}
    return "\n".join(filter(None, [value_lines(others), ALL_OTHERS_FALSE]))


def _words(atom: Atom, count: int) -> list[tuple[Atom, bool]]:
    """``atom`` and the same in at most ``count`` - 1 other words; True for words of the contrary."""
    source = atom.predicate.source
    forms = [(atom, False)]
    if isinstance(source, FromVLM):
        others = [(w, False) for w in source.also] + [(w, True) for w in source.opposite]
        for word, negated in others[: count - 1]:
            said = replace(source, phrase=word, also=(), opposite=())
            name = f"{atom.predicate.name}{WORD_MARK}{word}"
            meaning = f"{'The contrary of' if negated else 'The same as'} {source.phrase}."
            forms.append(
                (Atom(replace(atom.predicate, name=name, source=said, description=meaning), atom.objects), negated)
            )
    return forms


def _majority(labels: Sequence[Label]) -> Label:
    """What most of the labels say that are not unknown; the first decides a tie, and stands if all are unknown."""
    votes = Counter(label for label in labels if label != Label.UNKNOWN)
    return votes.most_common(1)[0][0] if votes else labels[0]
