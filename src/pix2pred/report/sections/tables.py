"""Truth tables as compact JSON: a string of ``1``, ``0`` and ``?`` per atom, drawn by the page when looked at."""

from __future__ import annotations

from typing import Any

import numpy as np

from pix2pred.predicates.labelling.evidence import PictureDoc
from pix2pred.report.contents import Contents
from pix2pred.report.pictures import Album
from pix2pred.report.sections.attention import Suspicion
from pix2pred.structs import Label, LabelledDemo, Predicate, TruthTable
from pix2pred.structs.goals.words import shown as shown_goals
from pix2pred.structs.predicates import FromVLM, source_name

_LETTERS = {Label.TRUE: "1", Label.FALSE: "0", Label.UNKNOWN: "?"}


def tables(
    contents: Contents, suspicions: list[Suspicion], status: dict[str, dict[str, str]], album: Album
) -> dict[str, Any]:
    """Predicates, demonstrations with labels and explanations, pictures by their number in ``album``.

    ``status`` is by the model's name.
    """
    shown = contents.shown
    chosen = {name for name, entry in status.items() if entry["status"] == "selected"}
    pool = sorted((c.predicate for c in shown.pool), key=lambda p: (p.name not in chosen, p))
    predicates = (*(p for p in pool if p.name in chosen), *sorted(shown.initial), *pool[len(chosen) :])
    numbers = {p: i for i, p in enumerate(predicates)}
    said = {demo.name: demo for demo in contents.said.demos}
    evidence = {demo.name: demo for demo in contents.evidence.demos}
    demos = []
    for demo in shown.demos:
        known = evidence.get(demo.name)
        descriptors = known.descriptors if known else {}
        order = sorted(range(len(demo.atoms)), key=lambda i: (numbers[demo.atoms[i].predicate], demo.atoms[i]))
        labels = {demo.atoms[i]: _row(demo, i) for i in order}
        original = {a: _row(said[demo.name], i) for i, a in enumerate(said[demo.name].atoms)}
        blank = "0" * (len(demo.actions) + 1)
        atoms = [demo.atoms[i] for i in order]
        objects = sorted(demo.objects)
        index = {o: i for i, o in enumerate(objects)}
        demos.append(
            {
                "name": demo.name,
                "objects": [[o.name, o.type.name, descriptors.get(o.name, "")] for o in objects],
                "goal": shown_goals(demo.goals),
                "actions": [{"text": str(a), "objects": [index[o] for o in a.objects]} for a in demo.actions],
                "atoms": [[numbers[a.predicate], *(index[o] for o in a.objects)] for a in atoms],
                "labels": [labels[a] for a in atoms],
                "said": {i: o for i, a in enumerate(atoms) if (o := original.get(a, blank)) != labels[a]},
                "why": {i: known.why[str(a)] for i, a in enumerate(atoms) if known and str(a) in known.why},
                "states": [[_picture(p, album) for p in pictures] for pictures in (known.states if known else ())],
            }
        )
    return {
        "predicates": [_predicate(p, shown, status) for p in predicates],
        "demos": demos,
        "explanations": list(contents.evidence.explanations),
        "suspicions": [s.as_dict() for s in suspicions],
    }


def _picture(picture: PictureDoc, album: Album) -> dict[str, Any]:
    return {
        "camera": picture.camera,
        "picture": album.number(picture.digest),
        "size": picture.size,
        "boxes": picture.boxes,
        "crop": picture.crop,
    }


def _row(demo: LabelledDemo, column: int) -> str:
    return "".join(_LETTERS[Label(v)] for v in np.asarray(demo.values[:, column]))


def _predicate(p: Predicate, shown: TruthTable, status: dict[str, dict[str, str]]) -> dict[str, Any]:
    return {
        "name": p.name,
        "types": [t.name for t in p.types],
        "given": p in shown.initial,
        "source": source_name(p.source),
        "phrase": p.source.phrase if isinstance(p.source, FromVLM) else "",
        "status": status.get(p.name, {}).get("status", "given" if p in shown.initial else "candidate"),
    }
