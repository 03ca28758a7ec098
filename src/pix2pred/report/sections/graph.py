"""Which operator makes which other one possible: causal links of the demonstrations, drawn as a graph.

A link goes from the operator that last made an atom true to an operator that needs it. Operators stand from left to
right in the order in which the demonstrations use them, and one below another when they are used at about the same
time, so that most links point right.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pix2pred.learning import Support, SupportKind
from pix2pred.structs import LabelledDemo, Operator

WIDTH, HEIGHT, GAP_X, GAP_Y, MARGIN, ABOVE = 118.0, 50.0, 46.0, 30.0, 14.0, 84.0
SLOTS_PER_OPERATOR = 0.8
"""Columns per operator at most; fewer when several are used at the same time."""


@dataclass(frozen=True, slots=True)
class Node:
    """The box of an operator, called ``name``, of a ``skill``.

    ``x`` and ``y`` are its upper left corner in pixels.
    """

    name: str
    skill: str
    x: float
    y: float


@dataclass(frozen=True, slots=True)
class Link:
    """A curve between two boxes, the atoms it stands for, and how often it occurred."""

    source: str
    target: str
    path: str
    title: str
    width: float


@dataclass(frozen=True, slots=True)
class Graph:
    """The drawing: a box for every operator and a curve wherever one makes true what another needs.

    ``width`` and ``height`` are in pixels.
    """

    nodes: tuple[Node, ...]
    links: tuple[Link, ...]
    width: float
    height: float


def operator_graph(operators: Sequence[Operator], readings: Sequence[Support], demos: Sequence[LabelledDemo]) -> Graph:
    """Lay out ``operators`` by the transitions that support them."""
    by_name = {op.name: op for op in operators}
    used = {
        (r.demo, r.step): r for r in readings if r.verdict == SupportKind.SUPPORTS
    }  # the last of several that fit equally
    nodes = _layout(operators, used, {d.name: len(d.actions) for d in demos})
    placed = {node.name: node for node in nodes}
    links = []
    counts, atoms = _links(by_name, used, demos)
    most = max(counts.values(), default=1)
    for (source, target), count in sorted(counts.items()):
        names = ", ".join(sorted(atoms[source, target]))
        title = f"{source} → {target}: {names} ({count} time{'s' if count > 1 else ''})"
        path = _curve(placed[source], placed[target])
        links.append(Link(source, target, path, title, round(1 + 2.5 * count / most, 2)))
    width = max((n.x for n in nodes), default=0) + WIDTH + MARGIN
    height = max((n.y for n in nodes), default=0) + HEIGHT + 4 * MARGIN
    return Graph(tuple(nodes), tuple(links), width, height)


def _layout(
    operators: Sequence[Operator], used: Mapping[tuple[str, int], Support], lengths: Mapping[str, int]
) -> list[Node]:
    when: dict[str, list[float]] = defaultdict(list)
    for (demo, step), reading in used.items():
        when[reading.operator].append(step / max(1, lengths[demo] - 1))
    mean = {op.name: sum(t) / len(t) if (t := when.get(op.name)) else 1.0 for op in operators}
    columns = max(1, min(len(operators), round(SLOTS_PER_OPERATOR * len(operators))))
    rows: Counter[int] = Counter()
    nodes = []
    ranked = sorted(operators, key=lambda op: (round(mean[op.name], 6), op.name))
    for op in ranked:
        column = min(columns - 1, int(mean[op.name] * columns))
        nodes.append((op, column, rows[column]))
        rows[column] += 1
    filled = {column: i for i, column in enumerate(sorted(rows))}
    return [
        Node(
            op.name,
            op.skill.name,
            MARGIN + filled[column] * (WIDTH + GAP_X),
            ABOVE + row * (HEIGHT + GAP_Y) + (filled[column] % 2) * 18,
        )
        for op, column, row in nodes
    ]


def _links(
    operators: Mapping[str, Operator], used: Mapping[tuple[str, int], Support], demos: Sequence[LabelledDemo]
) -> tuple[Counter[tuple[str, str]], dict[tuple[str, str], set[str]]]:
    counts: Counter[tuple[str, str]] = Counter()
    names: dict[tuple[str, str], set[str]] = defaultdict(set)
    for demo in demos:
        objects = {o.name: o for o in demo.objects}
        achiever: dict[str, str] = {}
        for step in range(len(demo.actions)):
            reading = used.get((demo.name, step))
            if reading is None:
                continue
            ground = operators[reading.operator].ground(tuple(objects[o] for o in reading.binding))
            sources: dict[str, set[str]] = defaultdict(set)
            for atom in ground.preconditions:
                if str(atom) in achiever:
                    sources[achiever[str(atom)]].add(atom.predicate.name)
            for source, found in sources.items():
                counts[source, reading.operator] += 1
                names[source, reading.operator] |= found
            achiever |= {str(a): reading.operator for a in ground.add}
    return counts, names


def _curve(a: Node, b: Node) -> str:
    """A cubic curve from the right of ``a`` to the left of ``b``; links backwards go round above."""
    if a is b:
        x, y = a.x + WIDTH / 2, a.y
        return f"M{x - 16:.1f},{y:.1f} C{x - 34:.1f},{y - 34:.1f} {x + 34:.1f},{y - 34:.1f} {x + 16:.1f},{y:.1f}"
    if b.x > a.x:
        x0, y0, x1, y1 = a.x + WIDTH, a.y + HEIGHT / 2, b.x, b.y + HEIGHT / 2
        bend = max(28.0, (x1 - x0) / 2)
        far = x1 - x0 > WIDTH
        lift = 34 + 0.05 * (x1 - x0) if far else 0.0
        return f"M{x0:.1f},{y0:.1f} C{x0 + bend:.1f},{y0 + lift:.1f} {x1 - bend:.1f},{y1 + lift:.1f} {x1:.1f},{y1:.1f}"
    x0, y0, x1, y1 = a.x + WIDTH * 0.35, a.y, b.x + WIDTH * 0.65, b.y
    if a.x == b.x:
        down = b.y > a.y
        x0 = x1 = a.x + WIDTH * (0.4 if down else 0.6)
        y0, y1 = (a.y + HEIGHT, b.y) if down else (a.y, b.y + HEIGHT)
        return f"M{x0:.1f},{y0:.1f} L{x1:.1f},{y1:.1f}"
    top = max(8.0, min(y0, y1) - 34 - 0.07 * (x0 - x1))
    return f"M{x0:.1f},{y0:.1f} C{x0:.1f},{top:.1f} {x1:.1f},{top:.1f} {x1:.1f},{y1:.1f}"
