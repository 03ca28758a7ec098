"""What the demonstrations of a run teach: their corrected labels, and the likely values of those learning doubts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from pix2pred.learning import Traces, load_traces
from pix2pred.learning.labels.doubts import Doubt, doubted
from pix2pred.predicates import CORRECTIONS, load_corrections
from pix2pred.predicates.labelling.evidence import DemoEvidence, PictureDoc, load_evidence
from pix2pred.runs.distilling.pictures import Stores
from pix2pred.runs.folder import RunFolder, RunFolderError
from pix2pred.runs.layout import EVIDENCE, MODEL, TRACES
from pix2pred.structs import Atom, FromVLM, Label, LabelledDemo, Picture, Predicate, WorldModel
from pix2pred.structs.formats.world_model import load_model
from pix2pred.vlm.distilled.fitting.lesson import Example
from pix2pred.vlm.offline.label_question import Look

LEAST_WEIGHT = 0.2
"""Labels that are as likely wrong as right teach nothing and are left out."""


@dataclass(slots=True)
class TeachingMaterial:
    """Looks with their labels, the demonstration or episode of each, and counts for the card.

    ``predicates`` are those that are taught; ``digests`` are those of each look's pictures; ``lost`` counts looks
    without a picture.
    """

    model: WorldModel
    predicates: frozenset[Predicate]
    looks: list[Look] = field(default_factory=list)
    groups: list[str] = field(default_factory=list)
    examples: list[Example] = field(default_factory=list)
    digests: list[tuple[str, ...]] = field(default_factory=list)
    demonstrations: int = 0
    episodes: int = 0
    corrected: int = 0
    doubted: int = 0
    lost: int = 0

    @property
    def words(self) -> set[str]:
        """The words of the predicates."""
        return {str(p.source.phrase) for p in self.predicates if isinstance(p.source, FromVLM)}

    def add(self, look: Look, group: str, digests: tuple[str, ...]) -> int:
        """Add a look whose pictures have these digests: reading them again would take longer. Gives its number."""
        self.looks.append(look)
        self.groups.append(group)
        self.digests.append(digests)
        return len(self.looks) - 1


def taught_by_demonstrations(run: RunFolder, stores: Stores, *, everything: bool) -> TeachingMaterial:
    """The labels of the predicates of the world model, or of ``everything`` in the pool.

    Raises ``RunFolderError`` for a run that was not finished.
    """
    for name in (TRACES, EVIDENCE, MODEL):
        if not (run.path / name).exists():
            raise RunFolderError(f"{run.path / name}: is missing; finish the run with 'pix2pred learn DATA --out RUN'")
    traces, model = load_traces(run.path / TRACES), load_model(run.path / MODEL)
    predicates = _wanted(traces, frozenset(model.predicates), everything=everything)
    evidence = {demo.name: demo for demo in load_evidence(run.path / EVIDENCE).demos}
    found = TeachingMaterial(model, predicates)
    doubts = _doubts(traces, predicates)
    corrected = {(*cell[:2], tuple(cell[2])) for cell in load_corrections(run.path / CORRECTIONS).labels}
    for demo in traces.table.demos:
        if demo.name in evidence:
            found.demonstrations += 1
            _add_demo(found, demo, evidence[demo.name], predicates, doubts, corrected, stores)
    return found


def _wanted(traces: Traces, of_model: frozenset[Predicate], *, everything: bool) -> frozenset[Predicate]:
    names = {p.name for p in of_model}
    pool = (*traces.table.initial, *(c.predicate for c in traces.table.pool))
    return frozenset(p for p in pool if isinstance(p.source, FromVLM) and (everything or p.name in names))


def _doubts(traces: Traces, predicates: frozenset[Predicate]) -> dict[tuple[str, Atom, int], Doubt]:
    return {
        (timeline.demo, timeline.atom, doubt.state): doubt
        for timeline in doubted(traces.table, sorted(predicates), unusual=True)
        for doubt in timeline.doubts
    }


def _add_demo(
    found: TeachingMaterial,
    demo: LabelledDemo,
    evidence: DemoEvidence,
    predicates: frozenset[Predicate],
    doubts: Mapping[tuple[str, Atom, int], Doubt],
    corrected: set[tuple[str, int, tuple[str, ...]]],
    stores: Stores,
) -> None:
    spoken = {o.name: replace(o, descriptor=evidence.descriptors.get(o.name, o.name)).prompt_name for o in demo.objects}
    types = {spoken[o.name]: o.type.name for o in demo.objects}
    columns = [(i, atom) for i, atom in enumerate(demo.atoms) if atom.predicate in predicates]
    for state, docs in enumerate(evidence.states):
        pictures = tuple(_pictures(docs, spoken, stores))
        if len(pictures) < len(docs) or not docs:
            found.lost += 1
            continue
        number = found.add(Look(pictures, types), demo.name, tuple(doc.digest for doc in docs))
        for column, atom in columns:
            label = Label(int(demo.values[state, column]))
            doubt = doubts.get((demo.name, atom, state))
            weight = 1.0
            if (demo.name, state, (atom.predicate.name, *(o.name for o in atom.objects))) in corrected:
                found.corrected += 1
            elif doubt is not None:
                label, weight = doubt.likely, 2 * doubt.wrong - 1
                found.doubted += 1
            if label == Label.UNKNOWN or weight < LEAST_WEIGHT:
                continue
            source = atom.predicate.source
            assert isinstance(source, FromVLM), "only asked predicates are wanted"
            names = tuple(spoken[o.name] for o in atom.objects)
            found.examples.append(Example(number, source.phrase, names, label == Label.TRUE, weight))


def _pictures(docs: tuple[PictureDoc, ...], spoken: Mapping[str, str], stores: Stores) -> Iterator[Picture]:
    for doc in docs:
        boxes = {spoken[name]: corners for name, corners in doc.boxes.items() if name in spoken}
        picture = stores.picture(doc.camera, doc.digest, boxes)
        if picture is not None:
            yield picture
