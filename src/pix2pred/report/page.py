"""One HTML file: templates filled with a run's contents, styles, program and data inside, nothing loaded from outside.

Templates escape everything; the page's program writes text, never markup; the content security policy allows the two
scripts by their digests and pictures that are in the page, and nothing else.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections import defaultdict
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from pix2pred import __version__
from pix2pred.learning import Support, SupportKind
from pix2pred.learning.operators.sharing import sharing
from pix2pred.predicates import Corrections
from pix2pred.report.contents import Contents
from pix2pred.report.pictures import Album
from pix2pred.report.sections.attention import suspicions, unsure
from pix2pred.report.sections.changes import changes
from pix2pred.report.sections.curve import j_text, selection_curve
from pix2pred.report.sections.graph import HEIGHT, WIDTH, operator_graph
from pix2pred.report.sections.plans import episodes
from pix2pred.report.sections.pool import pool_entries, rejected_lines
from pix2pred.report.sections.questions import questions
from pix2pred.report.sections.shots import shots
from pix2pred.report.sections.tables import tables
from pix2pred.runs.verdict import meaning, spoken

SCRIPTS = ("page.js", "review.js")


def render(contents: Contents, *, review: bool = False) -> str:
    """The report as one HTML file; with ``review`` it is the page that ``pix2pred review`` serves."""
    suspicious = suspicions(contents)
    pool = pool_entries(contents)
    album = Album(contents.folder, contents.blobs)
    data = tables(contents, suspicious, {e.name: {"status": e.status, "shown": e.shown} for e in pool}, album)
    data["operators"] = {op.name: op.skill.name for op in contents.model.operators}
    data["review"] = review
    data["corrections"] = as_json(contents.corrections)
    data["learned"] = int(contents.metrics.get("corrections", 0))
    pictured = shots(contents, contents.readings, album)
    scripts = [asset(name) for name in SCRIPTS[: 2 if review else 1]]
    settings = contents.config["settings"]["learning"]
    threshold = settings["j_threshold"] if settings["early_stop"] == "level" else None
    operators = {op.name: op for op in contents.model.operators}
    template = environment().get_template("page.html.j2")
    return template.render(
        c=contents,
        version=__version__,
        name=_name(contents),
        review=review,
        style=Markup(asset("style.css")),
        scripts=[Markup(s) for s in scripts],
        policy=policy(scripts, served=review),
        data=Markup(_safe_json(data)),
        pictures=[uri or "" for uri in album.uris()],
        pool=pool,
        shots=pictured,
        spoken=spoken,
        meanings={p.name: words for p in contents.model.predicates if (words := meaning(p))},
        questions=questions(contents),
        rejected=rejected_lines(contents),
        curve=selection_curve(contents.selection["steps"], threshold),
        j_text=j_text,
        graph=operator_graph(contents.model.operators, contents.readings, contents.table.demos),
        box=(WIDTH, HEIGHT),
        evidence=_by_operator(contents.readings),
        sharing=sharing(contents.model.operators, contents.table.demos),
        solved={name: (summary, episodes(summary, operators)) for name, summary in contents.solved.items()},
        usage=_usage(contents.timings),
        changes=changes(contents),
        suspicions=suspicious,
        unsure=unsure(contents),
        demo_numbers={demo.name: d for d, demo in enumerate(contents.shown.demos)},
    )


def _name(contents: Contents) -> str:
    """The run folder's name, after its parent's where it is but called ``run``."""
    folder = contents.folder.resolve()
    name = f"{folder.parent.name}/{folder.name}" if folder.name == "run" else folder.name
    return name.encode(errors="replace").decode()  # names of folders need not be text


def as_json(corrections: Corrections) -> dict[str, Any]:
    """The corrections in force, as the page knows them."""
    return {
        "count": corrections.count,
        "labels": [[demo, state, list(atom), label] for (demo, state, atom), label in corrections.labels.items()],
        "names": corrections.names,
        "merged": corrections.merged,
        "standing": corrections.standing,
    }


def environment() -> Environment:
    """What fills in the templates of this room; it escapes everything."""
    made = Environment(
        loader=PackageLoader("pix2pred.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["thousands"] = lambda x: f"{x:,.0f}"
    return made


def asset(name: str) -> str:
    """A file beside the templates."""
    return (files("pix2pred.report") / "templates" / name).read_text(encoding="utf-8")


def policy(scripts: list[str], *, served: bool) -> str:
    """What a page may load: its own scripts, and from the server that serves it, if one does."""
    digests = " ".join(f"'sha256-{base64.b64encode(hashlib.sha256(s.encode()).digest()).decode()}'" for s in scripts)
    connect = "; connect-src 'self'" if served else ""
    own = " 'self'" if served else ""
    return (
        f"default-src 'none'; script-src {digests}; style-src 'unsafe-inline'; img-src data: blob:{own}{connect}; "
        "base-uri 'none'; form-action 'none'"
    )


def _safe_json(data: Any) -> str:
    """JSON that cannot end the script element it stands in."""
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False)
    for sign in "<>&\u2028\u2029":
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    return text


def _by_operator(readings: list[Support]) -> dict[str, dict[str, list[Support]]]:
    grouped: dict[str, dict[str, list[Support]]] = defaultdict(lambda: {"for": [], "against": []})
    for reading in readings:
        grouped[reading.operator]["for" if reading.verdict == SupportKind.SUPPORTS else "against"].append(reading)
    return grouped


def _usage(timings: Any) -> tuple[list[str], list[tuple[str, list[Any]]]]:
    """Column names and a row per purpose, whatever is counted."""
    queries = timings.get("queries", {})
    columns = list(dict.fromkeys(key for counts in queries.values() for key in counts))
    return columns, [(purpose, [counts.get(c, "") for c in columns]) for purpose, counts in queries.items()]
