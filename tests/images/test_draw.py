"""Views as a model sees them: sizes, marks, headings, crops."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import ClassVar

import numpy as np
import PIL.Image
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pix2pred.images.draw
import pix2pred.images.shown
from pix2pred.domains.burger.drawing.render import render
from pix2pred.domains.burger.world import EDGE_CELLS, BurgerWorld, Cell, Heading, Thing
from pix2pred.images import ShownPictures, draw_view, encode_png, skill_crop
from pix2pred.images.marks import Mark, place_names
from pix2pred.structs import Box, Image, Picture, Pixels, State
from pix2pred.structs.views import FOOT_HEIGHT, HEADING_HEIGHT, NOTE_HEIGHT, View

GREY = np.full((200, 300, 3), 128, np.uint8)
BOXES = {"cup": Box(40, 40, 80, 80), "box": Box(200, 100, 260, 160)}
PLAIN = View(Picture("main", Image.from_pixels(GREY), BOXES), 0, marks=False, longest_side=300)
MARKED = replace(PLAIN, marks=True)

STACK = ("bottom_bun1", "patty1", "lettuce1", "cheese1", "patty2", "top_bun1")


def kitchen(stack_cell: Cell = Cell(4, 1), held: str | None = None) -> BurgerWorld:  # noqa: B008
    """The tallest stack, a burger beside it, and covered stations."""
    tall = [Thing(n, n[:-1], stack_cell, z) for z, n in enumerate(STACK)]
    burger = [Thing(n, n[:-1], Cell(4, 3), z) for z, n in enumerate(("bottom_bun2", "patty3", "top_bun2"))]
    stations = [
        Thing("grill", "grill", Cell(0, 2)), Thing("patty4", "patty", Cell(0, 2), 1),
        Thing("cutting_board", "cutting_board", Cell(0, 3)), Thing("lettuce2", "lettuce", Cell(0, 3), 1),
    ]  # fmt: skip
    return BurgerWorld("robot", Cell(2, 2), Heading.DOWN, held, (*tall, *burger, *stations), 3)


@pytest.mark.parametrize(
    ("size", "side", "crop", "shape"),
    [
        ((300, 200), 300, None, (200, 300)),
        ((300, 200), 512, None, (341, 512)),
        ((200, 300), 100, None, (100, 67)),
        ((1000, 1), 512, None, (1, 512)),
        ((300, 200), 512, Box(10, 10, 110, 60), (256, 512)),
        ((300, 200), 100, Box(10.5, 10.25, 20.5, 30.25), (100, 50)),
    ],
)
def test_the_longer_side_is_as_asked(
    size: tuple[int, int], side: int, crop: Box | None, shape: tuple[int, int]
) -> None:
    image = Image.from_pixels(np.zeros((size[1], size[0], 3), np.uint8))
    view = View(Picture("main", image), 0, crop, longest_side=side)
    assert draw_view(view).shape == (*shape, 3)
    with_heading = draw_view(replace(view, heading="state 0"))
    assert with_heading.shape == (shape[0] + HEADING_HEIGHT, shape[1], 3)
    assert (view.shown_size, replace(view, heading="state 0").shown_size) == (
        draw_view(view).shape[1::-1],
        with_heading.shape[1::-1],
    )


def test_without_marks_and_heading_the_picture_is_unchanged() -> None:
    assert np.array_equal(draw_view(PLAIN), GREY)


def test_the_heading_is_black_on_white_above_the_picture() -> None:
    drawn = draw_view(replace(PLAIN, heading="state 12, camera main"))
    strip, rest = drawn[:HEADING_HEIGHT], drawn[HEADING_HEIGHT:]
    assert np.array_equal(rest, GREY)
    assert strip.max() == 255 and strip.min() < 80
    assert (strip[0] == 255).all()
    other = draw_view(replace(PLAIN, heading="state 13, camera main"))
    assert not np.array_equal(other[:HEADING_HEIGHT], strip)


def test_marks_are_drawn_beside_their_boxes_only() -> None:
    changed = (draw_view(MARKED)[:-FOOT_HEIGHT] != draw_view(PLAIN)).any(axis=2)
    near = np.zeros_like(changed)
    for box in BOXES.values():
        x = box.center[0]
        near[int(box.top) - 30 : int(box.bottom) + 30, int(x) - 60 : int(x) + 60] = True
        assert changed[int(box.top) - 30 : int(box.bottom) + 30, int(x) - 60 : int(x) + 60].any()
    assert not (changed & ~near).any()
    assert MARKED.shown_size == draw_view(MARKED).shape[1::-1]


def test_names_decide_what_is_written() -> None:
    named = replace(MARKED, picture=replace(MARKED.picture, boxes={"cat": BOXES["cup"], "box": BOXES["box"]}))
    assert not np.array_equal(draw_view(named), draw_view(MARKED))


def test_drawing_is_repeatable_and_does_not_depend_on_the_order_of_boxes() -> None:
    turned = replace(MARKED, picture=replace(MARKED.picture, boxes=dict(reversed(BOXES.items()))))
    assert encode_png(draw_view(MARKED)) == encode_png(draw_view(turned))


def test_a_crop_shows_its_part_and_its_marks_only() -> None:
    pixels = np.random.default_rng(0).integers(0, 256, (200, 300, 3), dtype=np.uint8)
    picture = Picture("main", Image.from_pixels(pixels), BOXES)
    crop = Box(180, 80, 280, 180)
    assert np.array_equal(draw_view(View(picture, 0, crop, False, longest_side=100)), pixels[80:180, 180:280])
    only = replace(picture, boxes={"box": BOXES["box"]})
    both = draw_view(View(picture, 0, crop, True))
    assert np.array_equal(both, draw_view(View(only, 0, crop, True)))


@settings(max_examples=25, deadline=None)
@given(
    st.dictionaries(
        st.text(min_size=1, max_size=30),
        st.builds(lambda x, y, w, h: Box(x, y, x + w, y + h), *[st.floats(-50, 350)] * 2, *[st.floats(0, 400)] * 2),
        max_size=6,
    ),
    st.text(max_size=40),
)
def test_any_boxes_names_and_headings_can_be_drawn(boxes: dict[str, Box], heading: str) -> None:
    view = replace(MARKED, heading=heading, picture=replace(MARKED.picture, boxes=boxes))
    marked = any(0 <= b.center[0] < 300 and 0 <= b.center[1] < 200 for b in boxes.values())
    height = 200 + (HEADING_HEIGHT if heading else 0) + (FOOT_HEIGHT if marked else 0)
    assert draw_view(view).shape == (height, 300, 3)


def labels(view: View, monkeypatch: pytest.MonkeyPatch) -> list[Box]:
    """Where labels are drawn."""
    spots: list[Box] = []
    original = pix2pred.images.draw._write

    def record(image: PIL.Image.Image, label: PIL.Image.Image, spot: Box) -> None:
        spots.append(spot)
        original(image, label, spot)

    with monkeypatch.context() as patched:
        patched.setattr(pix2pred.images.draw, "_write", record)
        draw_view(view)
    return spots


def overlap(a: Box, b: Box) -> bool:
    return min(a.right, b.right) > max(a.left, b.left) and min(a.bottom, b.bottom) > max(a.top, b.top)


@pytest.mark.parametrize("cell", [c for c in EDGE_CELLS if c not in (Cell(4, 3), Cell(0, 2), Cell(0, 3))], ids=str)
@pytest.mark.parametrize("held", [None, "top_bun1"])
def test_labels_of_the_tallest_stack_do_not_overlap(
    cell: Cell, held: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    world = kitchen(cell, held)
    if held:
        world = world.changed(replace(world.thing(held), cell=world.cell, z=1))
    picture = render(world)
    spots = labels(View(picture, 0), monkeypatch)
    assert len(spots) == len(picture.boxes) == 14
    assert not [1 for a, b in combinations(spots, 2) if overlap(a, b)]
    assert all(s.left >= 0 and s.top >= 0 and s.right <= 512 and s.bottom <= 512 + FOOT_HEIGHT for s in spots)


def test_the_name_of_a_table_stands_on_its_top_or_points_at_it() -> None:
    table, size = Box(100, 50, 400, 300), {"desk": (34.0, 18.0), "bin": (30.0, 18.0)}
    (alone,) = place_names({"desk": table}, size, (512, 512))
    assert alone.line is None and table.top <= alone.spot.top and alone.spot.bottom < table.center[1]
    full = {"desk": table, "bin": Box(90, 30, 410, 120)}  # nothing may be written on its upper part
    desk = next(m for m in place_names(full, size, (512, 512)) if m.name == "desk")
    assert desk.line and table.left < desk.line[1][0] < table.right and 120 < desk.line[1][1] < table.bottom


def test_crops_cover_the_skill_in_both_states_with_a_margin() -> None:
    after = replace(PLAIN.picture, boxes=BOXES | {"cup": Box(100, 40, 140, 80)})
    before, later = State((PLAIN.picture,)), State((after,))
    assert skill_crop(before, later, ["cup"], 0, (300, 200)) == Box(25, 25, 155, 95)
    assert skill_crop(before, later, ["cup", "box"], 0, (300, 200)) == Box(7, 7, 293, 193)
    assert skill_crop(before, later, ["cup", "box"], 0, (270, 150)) == Box(7, 7, 270, 150)


def test_crops_need_a_box() -> None:
    state = State((PLAIN.picture,))
    assert skill_crop(state, state, ["nothing"], 0, (300, 200)) is None
    assert skill_crop(state, state, [], 0, (300, 200)) is None
    one = State((replace(PLAIN.picture, boxes={}),))
    assert skill_crop(one, state, ["cup"], 0, (300, 200)) == Box(32, 32, 88, 88)


def test_a_crop_around_a_point_can_be_drawn() -> None:
    state = State((replace(PLAIN.picture, boxes={"cup": Box(40, 40, 40, 40)}),))
    draw_view(replace(PLAIN, crop=skill_crop(state, state, ["cup"], 0, (300, 200))))


def test_shown_pictures_are_drawn_views_and_costly_work_is_done_once(monkeypatch: pytest.MonkeyPatch) -> None:
    decoded: list[str] = []
    drawn: list[View] = []
    pixels_of, draw = Image.pixels, pix2pred.images.draw.draw_scene

    def pixels(image: Image) -> Pixels:
        decoded.append(image.digest)
        return pixels_of(image)

    def scene(view: View, decode: object) -> Pixels:
        drawn.append(view)
        return draw(view, decode)  # type: ignore[arg-type]

    random = np.random.default_rng(2)
    pictures = [
        Picture("main", Image.from_pixels(random.integers(0, 256, (20, 30, 3), dtype=np.uint8))) for _ in range(3)
    ]
    views = [View(p, t, crop, heading=f"{t}") for p in pictures for t in range(2) for crop in (None, Box(1, 1, 9, 9))]
    wanted = [draw_view(view) for view in views]
    monkeypatch.setattr(Image, "pixels", pixels)
    monkeypatch.setattr(pix2pred.images.shown, "draw_scene", scene)
    shown = ShownPictures()
    files = [shown(view) for view in [*views, *views]]
    assert (len(decoded), len(drawn)) == (3, 6), "headings alone make no other scene"
    assert all(np.array_equal(pixels_of(Image(f)), w) for f, w in zip(files, wanted + wanted, strict=True))
    small = ShownPictures(packed_bytes=1, decoded_bytes=20 * 30 * 3)
    for number in (0, 1, 4, 0):
        small(views[number])
    assert decoded[3:] == [pictures[i].image.digest for i in (0, 1, 0)], "the one used longest ago made room"


def test_what_is_not_in_a_picture_is_named_below_it() -> None:
    noted = replace(MARKED, unseen=("jug", "lid"))
    assert (
        noted.note == "without a mark, hidden or out of view: jug, lid"
        and replace(noted, crop=Box(0, 0, 100, 100)).note == ""
    )
    drawn = draw_view(noted)
    assert drawn.shape[1::-1] == noted.shown_size and len(drawn) == len(draw_view(MARKED)) + NOTE_HEIGHT
    assert np.array_equal(drawn[:-NOTE_HEIGHT], draw_view(MARKED)) and drawn[-NOTE_HEIGHT:].min() < 80
    assert noted.canonical() == MARKED.canonical(), "what is unseen follows from the question"
    many = replace(MARKED, unseen=tuple(f"small_blue_cup_{i}" for i in range(9)))
    assert " ".join(many.note_rows) == many.note and len(many.note_rows) > 3, "no name is cut off"
    assert draw_view(many).shape[1::-1] == many.shown_size
    shown = ShownPictures()
    assert shown(MARKED) != shown(noted)
    assert np.array_equal(Image(shown(noted)).pixels(), drawn)


@pytest.mark.parametrize("words", [1, 5, 20, 200])
def test_a_heading_ends_inside_the_picture(words: int) -> None:
    narrow = replace(PLAIN, crop=Box(0, 0, 60, 200), heading=" ".join(["state"] * words))
    strip = draw_view(narrow)[:HEADING_HEIGHT]
    assert (strip[:, -6:] == 255).all() and strip.min() < 120


class TestNames:
    """Where names are written, and the lines that lead from them."""

    SIZES: ClassVar = dict.fromkeys("abc", (30, 12))

    def _placed(self, boxes: dict[str, Box], size: tuple[int, int] = (300, 220)) -> dict[str, Mark]:
        return {mark.name: mark for mark in place_names(boxes, self.SIZES, size)}

    def test_a_line_ends_on_its_own_object_where_no_other_covers_it(self) -> None:
        boxes = {"a": Box(100, 100, 200, 160), "b": Box(100, 60, 200, 140), "c": Box(100, 20, 200, 80)}
        marks = self._placed(boxes)
        ends = {name: mark.line[1] for name, mark in marks.items() if mark.line}
        assert ends, "three objects on one another need lines"
        for name, (x, y) in ends.items():
            holding = {n for n, b in boxes.items() if b.left <= x <= b.right and b.top <= y <= b.bottom}
            assert holding == {name}

    def test_a_name_right_below_its_object_needs_no_line(self) -> None:
        assert self._placed({"a": Box(100, 100, 140, 140)})["a"].line is None

    def test_a_name_beside_an_object_has_a_line(self) -> None:
        marks = self._placed({"a": Box(100, 180, 104, 220), "b": Box(60, 130, 160, 178)}, (300, 220))
        for mark in marks.values():
            box = {"a": Box(100, 180, 104, 220), "b": Box(60, 130, 160, 178)}[mark.name]
            centred = abs(mark.spot.center[0] - box.center[0]) < box.width / 2
            assert mark.line or centred

    @given(st.lists(st.tuples(*[st.integers(0, 250)] * 2, *[st.integers(5, 120)] * 2), min_size=3, max_size=3))
    def test_names_stay_inside_and_lines_begin_at_them(self, drawn: list[tuple[int, int, int, int]]) -> None:
        boxes = {name: Box(x, y, x + w, y + h) for name, (x, y, w, h) in zip("abc", drawn, strict=True)}
        for mark in self._placed(boxes, (400, 400)).values():
            assert mark.spot.left >= 0 and mark.spot.right <= 400 and mark.spot.top >= 0 and mark.spot.bottom <= 400
            if mark.line:
                x, y = mark.line[0]
                assert mark.spot.left <= x <= mark.spot.right and mark.spot.top <= y <= mark.spot.bottom
