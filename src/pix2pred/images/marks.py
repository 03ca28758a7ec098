"""Where the names of objects are written in a picture (method 2.1: set-of-marks), and the lines that lead to them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from pix2pred.structs import Box

Point = tuple[float, float]
"""(x, y) in the pixels of the shown picture."""

_OWN_OBJECT = 2000
"""What hiding an object by its own name weighs, as pixels of other objects: held things are small."""
_MISTAKEN = 200
"""What standing nearer to another object weighs, as pixels hidden: without a line the name would be taken for its."""
_CROSSED_NAME, _CROSSED_LINE, _CROSSED_OBJECT = 600, 400, 150
"""What a line weighs that crosses a name, another line or an object, as pixels hidden."""
_RINGS = (1.6, 3.0, 5.0)
"""How far from an object a name may stand when there is no room beside it, in heights of the name."""
_DIRECTIONS = 12
_GOOD = 120
"""What a name may hide and cross, in pixels, so that no better place is looked for farther away."""
_GRID = (0.15, 0.3, 0.5, 0.7, 0.85)
"""Where on an object a line may end, as shares of its box."""
_RIM = (0.0, 1.0)
"""The same for an object that the end of a line would hide."""
_TINY = 24
"""Pixels: what is smaller is pointed at from its rim."""
_LOWER_MIDDLE = (0.5, 0.65)
"""Where on an object a line ends best, as shares of its box: what lies on others covers their upper part."""
_LARGE = 8
"""Heights of a name that an object has on which the name may stand without a line."""
_RIGHT_BESIDE = 6
"""Pixels between a name and its object that need no line."""


@dataclass(frozen=True, slots=True)
class Mark:
    """Where the name of an object is written.

    ``spot`` is covered by the text; ``line`` leads from it to the object where one is needed. In pixels.
    """

    name: str
    spot: Box
    line: tuple[Point, Point] | None = None


def place_names(
    boxes: Mapping[str, Box], sizes: Mapping[str, tuple[float, float]], size: tuple[int, int]
) -> list[Mark]:
    """A place for every name, of ``sizes`` (width, height), in a picture of ``size``; lower objects come first.

    No name covers another where that can be helped; of the places left, the one is taken that hides the least of the
    objects and whose line crosses the least.
    """
    placed: list[Mark] = []
    for name, box in sorted(boxes.items(), key=lambda item: (-item[1].bottom, item[0])):
        others = [b for n, b in boxes.items() if n != name]
        placed.append(_Placing(name, box, others, placed).best(sizes[name], size))
    return placed


@dataclass(frozen=True)
class _Placing:
    """Finding a place for one name."""

    name: str
    box: Box
    others: Sequence[Box]
    placed: Sequence[Mark]

    def best(self, label: tuple[float, float], size: tuple[int, int]) -> Mark:
        best, least = None, (math.inf, math.inf)
        for spots in (_beside(self.box, *label, size), *(_around(self.box, *label, size, ring) for ring in _RINGS)):
            for spot in spots:
                names = sum(_overlap(spot, m.spot) for m in self.placed)
                if names > least[0]:
                    continue
                limit = least[1] if names == least[0] else math.inf
                if (hidden := self._hidden(spot, limit)) >= limit:
                    continue
                mark = Mark(self.name, spot, self._line(spot))
                if (cost := self._cost(hidden, mark)) < limit:
                    best, least = mark, (names, cost)
                if least == (0, 0):
                    return mark
            if least[0] == 0 and least[1] <= _GOOD:
                break
        assert best is not None, "there are always places beside an object"
        return best

    @cached_property
    def _end(self) -> Point:
        """The point of a grid on the object that the fewest others cover, as near to its lower middle as can be."""
        box, on_it = self.box, [o for o in self.others if _overlap(o, self.box)]
        ideal = (box.left + _LOWER_MIDDLE[0] * box.width, box.top + _LOWER_MIDDLE[1] * box.height)
        grid = _GRID if min(box.width, box.height) >= _TINY else _RIM
        points = [(box.left + x * box.width, box.top + y * box.height) for y in grid for x in grid]
        points.sort(key=lambda p: math.dist(p, ideal))
        for point in points:
            if not any(_holds(o, point) for o in on_it):
                return point
        return min(points, key=lambda p: sum(_holds(o, p) for o in on_it))

    def _line(self, spot: Box) -> tuple[Point, Point] | None:
        """No line is needed right below or above the object, or on it when it is large.

        Below a table the name would stand on the floor and name that: what is large and wide needs a line from there.
        """
        box, (x, _) = self.box, spot.center
        large = box.height > _LARGE * spot.height
        if large and _distance(spot.center, box) == 0:
            return None
        gap = min(abs(spot.top - box.bottom), abs(spot.bottom - box.top))
        under = gap < _RIGHT_BESIDE and abs(x - box.center[0]) < box.width / 2
        if under and not (large and box.width > box.height):
            return None
        end = self._end
        return (min(max(end[0], spot.left), spot.right), min(max(end[1], spot.top), spot.bottom)), end

    def _hidden(self, spot: Box, limit: float) -> float:
        """What a name hides, in pixels, and for how many objects it could be taken; any number from ``limit`` on."""
        center = spot.center
        own = _distance(center, self.box)
        cost = 0.0
        for other in self.others:
            cost += _overlap(spot, other) + _MISTAKEN * (own > 0 and _distance(center, other) < own)
            if cost >= limit:
                return cost
        return cost + _OWN_OBJECT * _overlap(spot, self.box) / max(1.0, self.box.width * self.box.height)

    def _cost(self, hidden: float, mark: Mark) -> float:
        """What is ``hidden``, and what the name and its line cross; in pixels."""
        cost = hidden + sum(_CROSSED_NAME for m in self.placed if m.line and _crosses(m.line, mark.spot))
        if mark.line:
            start, end = mark.line
            cost += math.dist(start, end)
            cost += sum(_CROSSED_NAME for m in self.placed if _crosses(mark.line, m.spot))
            cost += sum(_CROSSED_LINE for m in self.placed if m.line and _meet(mark.line, m.line))
            cost += sum(_CROSSED_OBJECT for o in self.others if not _holds(o, end) and _crosses(mark.line, o))
        return cost


def _inside(left: float, top: float, width: float, height: float, size: tuple[int, int]) -> Box:
    left = min(max(left, 0), max(0, size[0] - width))
    top = min(max(top, 0), max(0, size[1] - height))
    return Box(round(left), round(top), round(left + width), round(top + height))


def _beside(box: Box, width: float, height: float, size: tuple[int, int]) -> Iterator[Box]:
    """Places for a name, best first: under the object, beside its lower edge, above it; all inside the picture.

    On a large object it stands at the upper edge: the lower part of a table's box shows its legs and the floor.
    """
    x, _ = box.center
    on_it = box.top + 2 if box.height > _LARGE * height else box.bottom - height
    for left, top in (
        (x - width / 2, box.bottom + 1),
        (box.left - width - 2, box.bottom - height),
        (box.right + 2, box.bottom - height),
        (x - width / 2, box.top - height - 1),
        (box.left - width - 2, box.top),
        (box.right + 2, box.top),
        (x - width / 2, on_it),
        (x - width / 2, box.bottom + height + 2),
        (x - width / 2, box.top - 2 * height - 2),
    ):
        yield _inside(left, top, width, height, size)


def _around(box: Box, width: float, height: float, size: tuple[int, int], ring: float) -> Iterator[Box]:
    """Places on an oval around the object."""
    x, y = box.center
    across, along = ((side + own) / 2 + (ring - 1) * height for side, own in ((box.width, width), (box.height, height)))
    for i in range(_DIRECTIONS):
        angle = 2 * math.pi * i / _DIRECTIONS
        left, top = x + across * math.sin(angle) - width / 2, y + along * math.cos(angle) - height / 2
        yield _inside(left, top, width, height, size)


def _overlap(a: Box, b: Box) -> float:
    if a.right <= b.left or b.right <= a.left or a.bottom <= b.top or b.bottom <= a.top:  # nearly always
        return 0.0
    return (min(a.right, b.right) - max(a.left, b.left)) * (min(a.bottom, b.bottom) - max(a.top, b.top))


def _holds(box: Box, point: Point) -> bool:
    return box.left <= point[0] <= box.right and box.top <= point[1] <= box.bottom


def _distance(point: Point, box: Box) -> float:
    """How far a point is from a box; 0 inside it."""
    x, y = point
    across = box.left - x if x < box.left else x - box.right if x > box.right else 0.0
    along = box.top - y if y < box.top else y - box.bottom if y > box.bottom else 0.0
    return math.hypot(across, along)


def _crosses(line: tuple[Point, Point], box: Box) -> bool:
    """Whether a line passes through a box: the part of it that lies within both pairs of edges is not empty."""
    (x0, y0), (x1, y1) = line
    if max(x0, x1) <= box.left or box.right <= min(x0, x1) or max(y0, y1) <= box.top or box.bottom <= min(y0, y1):
        return False  # nearly always
    first, last = 0.0, 1.0
    for start, way, low, high in ((x0, x1 - x0, box.left, box.right), (y0, y1 - y0, box.top, box.bottom)):
        if way == 0:
            if not low < start < high:
                return False
            continue
        enters, leaves = sorted(((low - start) / way, (high - start) / way))
        first, last = max(first, enters), min(last, leaves)
    return first < last


def _meet(a: tuple[Point, Point], b: tuple[Point, Point]) -> bool:
    """Whether two lines cross: the ends of each lie on different sides of the other."""

    def side(line: tuple[Point, Point], point: Point) -> float:
        (x0, y0), (x1, y1) = line
        return (x1 - x0) * (point[1] - y0) - (y1 - y0) * (point[0] - x0)

    return side(a, b[0]) * side(a, b[1]) < 0 and side(b, a[0]) * side(b, a[1]) < 0
