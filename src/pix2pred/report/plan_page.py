"""The page of a plan for a photographed scene: which labels it rests on, and what came of executing it.

One HTML file without scripts; pictures are inside, small.
"""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Iterable
from dataclasses import dataclass

import PIL.Image
from markupsafe import Markup

from pix2pred import __version__
from pix2pred.execution import Guided, Missing, Need, PlannedScene, SeenStep
from pix2pred.execution.explaining.scene import said
from pix2pred.execution.explaining.wording import in_words
from pix2pred.images import draw_view, skill_crop
from pix2pred.report.page import asset, environment
from pix2pred.runs.verdict import doubts_about
from pix2pred.structs import Atom, FromVLM, GroundOperator, Label, PlanStatus, State
from pix2pred.structs.plans import Change, effects
from pix2pred.structs.predicates import source_name
from pix2pred.structs.states import Pixels
from pix2pred.structs.views import View

SIDE, CROP_SIDE, QUALITY = 880, 260, 82
"""Pixels of the longer side of a scene and of a crop, and their WebP quality."""

MOST_DRAWN = 500
"""Drawn pictures kept, since the page is made anew after every step; about 20 MB."""

_DRAWN: dict[str, str] = {}

MOST_USES = 5
"""Steps named beside a label that they need."""

POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"

OUTCOMES = {
    PlanStatus.SOLVED: "a plan",
    PlanStatus.UNSOLVABLE: "no plan",
    PlanStatus.BUDGET: "no plan within the budget",
    PlanStatus.NOT_FOUND: "no plan found",
    PlanStatus.TIMEOUT: "the planner was stopped",
}

_SOURCES = {
    "vlm": "labelled by the model",
    "human": "listed by a person",
    "domain": "listed with the photo",
    "skills": "declared: follows from the skills",
    "features": "computed from features",
    "opposite": "the contrary does not hold",
}


@dataclass(frozen=True, slots=True)
class LabelView:
    """An atom of the first look: its value in words, where it comes from, and the part of the photo it is about."""

    text: str
    value: str
    source: str
    probability: str
    believed: str
    why: str
    crop: str
    used: tuple[str, ...]
    more: int


@dataclass(frozen=True, slots=True)
class StepView:
    """A step of the plan; ``needs`` are (atom, number of the step that makes it true or 0)."""

    words: str
    action: str
    operator: str
    needs: tuple[tuple[str, int], ...]
    changes: tuple[Change, ...]


@dataclass(frozen=True, slots=True)
class LookView:
    """An executed step with the photos after it."""

    words: str
    look: SeenStep
    photos: tuple[str, ...]
    open: tuple[str, ...]
    explained: tuple[tuple[str, str], ...]


def render_plan(scene: PlannedScene, guided: Guided | None = None) -> str:
    """The page as one HTML file; with ``guided`` it also shows what was executed and what is left to do."""
    task = scene.task
    lacking: tuple[Missing, ...] = scene.missing
    wanted = dict.fromkeys([a for m in lacking for a in (m.atom, *m.lacks)])
    seen_wrong = [a for a in wanted if a not in scene.seen and a in scene.labels.values]
    steps = tuple(_step(s, n) for s, n in zip(scene.result.plan, scene.needs, strict=False))
    return environment().get_template("plan.html.j2").render(
        scene=scene, task=task, guided=guided, version=__version__, policy=POLICY,
        style=Markup(asset("style.css") + asset("plan.css")),
        outcome=OUTCOMES[scene.result.status],
        labelled_by=scene.solver.labeller.vlm.name,
        photos=_photos(task.initial, 0),
        steps=steps,
        doubts=doubts_about(scene.result.plan),
        goal_needs=_pairs(scene.needs[-1]) if scene.solved else (),
        rests=[_label(scene, a) for a in sorted(scene.rests_on, key=lambda a: a not in scene.labels.values)],
        unlabelled=[_label(scene, a) for a in scene.unlabelled],
        missing=lacking,
        unseen=[_label(scene, a) for a in seen_wrong],
        everything=[_label(scene, a, crop=False) for a in sorted({*scene.labels.values, *scene.seen})],
        looks=[_look(look, t) for t, look in enumerate(guided.looks, start=1)] if guided else (),
        remaining=[(in_words(s), effects(s)) for s in guided.remaining] if guided else (),
        lacking_now=guided.missing if guided else (),
    )  # fmt: skip


def _step(step: GroundOperator, needs: Iterable[Need]) -> StepView:
    action = f"{step.operator.skill.name}({', '.join(o.name for o in step.skill_objects)})"
    return StepView(in_words(step), action, step.operator.name, _pairs(needs), effects(step))


def _pairs(needs: Iterable[Need]) -> tuple[tuple[str, int], ...]:
    return tuple((str(n.atom), 0 if n.by is None else n.by + 1) for n in needs)


def _label(scene: PlannedScene, atom: Atom, *, crop: bool = True) -> LabelView:
    value = scene.labels.values.get(atom, Label.of(atom in scene.seen))
    without = atom in scene.unlabelled and value != Label.UNKNOWN
    word = "no answer" if without else value.word
    probability = scene.labels.confidence.get(atom)
    used = [str(i) for i, step in enumerate(scene.needs, start=1) for n in step if n.atom == atom and n.by is None]
    if used and used[-1] == str(len(scene.needs)):
        used[-1] = "goal"
    more = len(used) - MOST_USES
    return LabelView(
        str(atom), word, _SOURCES[source_name(atom.predicate.source)],
        "" if probability is None else f"{100 * probability:.0f} %",
        f"{100 * scene.believed[atom]:.1f} %" if atom in scene.believed else "",
        scene.said.get(atom, ""),
        _crop(scene.task.initial, atom) if crop and isinstance(atom.predicate.source, FromVLM) else "",
        tuple(used[:MOST_USES]),
        max(0, more),
    )  # fmt: skip


def _look(look: SeenStep, number: int) -> LookView:
    words = said(look.labels)
    concerned = {c.atom for c in (*look.expected, *look.absent, *look.surplus)}
    told = tuple((str(a), text) for a, text in words.items() if a in concerned)
    unknown = tuple(str(a) for a, v in sorted(look.labels.values.items()) if v == Label.UNKNOWN)
    return LookView(in_words(look.step), look, _photos(look.state, number), unknown, told)


def _photos(state: State, number: int) -> tuple[str, ...]:
    several = len(state.pictures) > 1
    views = [
        View(p, number, heading=f"camera {p.camera}" if several else "", longest_side=SIDE) for p in state.pictures
    ]
    return tuple(_uri(view) for view in views)


def _crop(state: State, atom: Atom) -> str:
    """The part of the first picture in which all of the atom's objects have boxes; empty when there is none."""
    names = [o.name for o in atom.objects]
    for camera, picture in enumerate(state.pictures):
        if all(name in picture.boxes for name in names):
            box = skill_crop(state, state, names, camera, picture.image.size)
            if box is not None:
                return _uri(View(picture, 0, box, marks=len(names) > 1, longest_side=CROP_SIDE))
    return ""


def _uri(view: View) -> str:
    key = json.dumps(view.canonical(), sort_keys=True)
    if key not in _DRAWN:
        if len(_DRAWN) >= MOST_DRAWN:
            _DRAWN.clear()
        _DRAWN[key] = _drawn(view)
    return _DRAWN[key]


def _drawn(view: View) -> str:
    pixels: Pixels = draw_view(view)
    buffer = io.BytesIO()
    PIL.Image.fromarray(pixels).save(buffer, "WEBP", quality=QUALITY, method=2)
    return "data:image/webp;base64," + base64.b64encode(buffer.getvalue()).decode()
