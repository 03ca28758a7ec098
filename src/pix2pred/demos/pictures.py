"""Finding the pictures of a state, and looking into them."""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from pix2pred.demos.files.documents import CAMERA_PATTERN, Sheet
from pix2pred.demos.files.folders import entries, is_folder, refusal
from pix2pred.demos.files.problems import Problem
from pix2pred.demos.files.yaml_lines import Loc
from pix2pred.structs import Box, Image, PictureError, Pixels
from pix2pred.structs.states import LARGE_PIXELS

ENDINGS = (".png", ".jpg", ".jpeg")
OTHER_PICTURES = (".bmp", ".gif", ".heic", ".heif", ".tif", ".tiff", ".webp")
MAX_BYTES = 100_000_000

SMALL_PICTURE = 100
"""Pixels of the shorter side, below which a picture is called unreadably small."""

SMALL_BOX = 5
"""The same for the box of an object."""

LOOKED_AT = 2048
"""Pixels of the longer side of what is looked at of a picture; more tells nothing about its use."""

BLANK = 2.0
"""Standard deviation, of 255, below which a picture shows nothing."""

GRID, AREA = 64, 8
"""Pictures are compared by the means of at most ``GRID x GRID`` areas, with sides of at least ``AREA`` pixels."""

ALIKE = 3
"""Pictures whose areas all differ by less than this (of 255) are alike."""

Thumbnail = NDArray[np.int16]

_CAMERA = re.compile(CAMERA_PATTERN)
PNG_START = b"\x89PNG\r\n\x1a\n"
JPEG_START = b"\xff\xd8\xff"


def find_pictures(folder: Path, wanted: Collection[str] | None, sheet: Sheet, loc: Loc, root: Path) -> dict[str, Path]:
    """The picture of each camera: of those ``wanted``, by default of all in ``folder`` (natural order)."""
    present = _present(folder, sheet.found, strict=wanted is None)
    pictures = {}
    for camera in present if wanted is None else wanted:
        if camera not in present:
            close = difflib.get_close_matches(camera, present, n=1)
            hint = f"; did you mean {close[0]!r}?" if close else ""
            sheet.report((*loc, "pictures", camera), f"there is no picture {folder / camera}.png or .jpg{hint}")
        elif message := refusal(present[camera], root):
            sheet.found.append(Problem(present[camera], None, message))
        else:
            pictures[camera] = present[camera]
    return pictures


def _present(folder: Path, found: list[Problem], *, strict: bool) -> dict[str, Path]:
    """The pictures in ``folder`` by camera; ``strict`` also reports pictures that cannot be used."""
    present: dict[str, Path] = {}
    for path in entries(folder, found):
        ending = path.suffix.lower()
        if ending in ENDINGS:
            if path.stem in present:
                message = f"camera {path.stem!r} has two pictures, {present[path.stem].name} and {path.name}; keep one"
                found.append(Problem(folder, None, message))
            elif strict and not _CAMERA.match(path.stem):
                message = f"{path.name!r}: name pictures after the camera, with letters, digits, '_' and '-' only"
                found.append(Problem(folder, None, message))
            else:
                present[path.stem] = path
        elif strict and ending in OTHER_PICTURES:
            found.append(
                Problem(folder, None, f"{path.name!r}: only PNG and JPEG are read; export or convert the picture")
            )
    return present


def check_image_folders(images: Path, states: int, found: list[Problem]) -> None:
    """Report what lies in ``images/`` and belongs to no state."""
    numbers = {str(t) for t in range(states)}
    for path in entries(images, found):
        if is_folder(path):
            if path.name not in numbers:
                what = f"folder {path.name!r} belongs to no state; folders are numbered from 0 to {states - 1}"
                found.append(Problem(images, None, what))
        elif path.suffix.lower() in ENDINGS:
            found.append(Problem(images, None, f"{path.name!r}: pictures go into images/<number of the state>/"))


@dataclass(frozen=True, slots=True)
class Shown:
    """The picture of one camera in one state: its file, and where objects are in it."""

    path: Path
    image: Image
    boxes: Mapping[str, Box]


def thumbnail(pixels: Pixels) -> Thumbnail:
    """The means of a grid of areas: what is left of a picture when its noise has averaged out."""
    height, width = (min(GRID, max(1, side // AREA)) for side in pixels.shape[:2])
    small = PIL.Image.fromarray(pixels).resize((width, height), PIL.Image.Resampling.BOX)
    return np.asarray(small, dtype=np.int16)


def difference(first: Thumbnail, second: Thumbnail) -> int:
    """The largest change of an area in one colour, of 255."""
    return int(np.abs(first - second).max())


@dataclass(frozen=True, slots=True)
class Size:
    """Extent of a picture in pixels."""

    width: int
    height: int

    def __str__(self) -> str:
        return f"{self.width}x{self.height}"


@dataclass(slots=True)
class PictureCheck:
    """Decodes the pictures of one demonstration and compares what it sees.

    What makes them unusable goes to the sheet, what will make them hard to read to ``warned``.
    """

    sheet: Sheet
    warned: list[Problem]
    sizes: dict[str, Size] = field(default_factory=dict)
    _before: dict[str, Thumbnail] = field(default_factory=dict)
    _said: set[tuple[str, str]] = field(default_factory=set)

    def look(self, pictures: Mapping[str, Shown], loc: Loc) -> None:
        """Look at the pictures of the state at ``loc``, which follows the one that was looked at before."""
        now: dict[str, Thumbnail] = {}
        for camera, shown in pictures.items():
            try:
                pixels = _decoded(shown.path, shown.image, LOOKED_AT)
                size = Size(*shown.image.size)
            except PictureError as error:
                message = str(error).removeprefix(f"{shown.path}: ")
                self.sheet.found.append(Problem(shown.path, None, message))
                continue
            now[camera] = thumbnail(pixels)
            self._compare_size(camera, shown, size, (*loc, "pictures", camera))
            if now[camera].std() < BLANK + 1 and float(pixels.std()) < BLANK:  # means differ less, but for rounding
                self.warned.append(Problem(shown.path, None, "shows one colour and nothing else"))
        self._compare_with_before(now, loc)

    def _compare_size(self, camera: str, shown: Shown, size: Size, loc: Loc) -> None:
        """Report another size than before, boxes that leave the picture, and what is too small to see."""
        first = self.sizes.setdefault(camera, size)
        if size != first:
            message = f"is {size} pixels, earlier pictures of camera {camera!r} are {first}; use one size"
            self.sheet.found.append(Problem(shown.path, None, message))
        if min(size.width, size.height) < SMALL_PICTURE:
            self._warn(camera, "", loc, f"pictures of {size} pixels are too small to tell things apart")
        if size.width * size.height > LARGE_PIXELS:
            message = f"pictures of {size} pixels take long, and no model is shown as many: bring in smaller copies"
            self._warn(camera, "", loc, f"{message} with 'pix2pred import frames'")
        for name, box in shown.boxes.items():
            if box.left < 0 or box.top < 0 or box.right > size.width or box.bottom > size.height:
                self.sheet.report((*loc, name), f"the box of {name!r} leaves the picture, which is {size} pixels")
            elif min(box.width, box.height) < SMALL_BOX and size.height >= SMALL_PICTURE:
                message = f"the box of {name!r} is {box.width:g}x{box.height:g} pixels: too small to see anything in it"
                self._warn(camera, name, (*loc, name), message)

    def _warn(self, camera: str, name: str, loc: Loc, message: str) -> None:
        """Once for each camera and object of the demonstration."""
        if (camera, name) not in self._said:
            self._said.add((camera, name))
            self.warned.append(Problem(self.sheet.file, self.sheet.yaml.line(loc), message))

    def _compare_with_before(self, now: dict[str, Thumbnail], loc: Loc) -> None:
        pairs = [(now[c], self._before[c]) for c in now if c in self._before]
        changes = [difference(a, b) for a, b in pairs if a.shape == b.shape]
        self._before = now
        if changes and max(changes) < ALIKE:
            message = "the pictures look the same as in the state before: nothing can be seen to change"
            self.warned.append(Problem(self.sheet.file, self.sheet.yaml.line(loc), message))


def load_picture(path: Path, longest: int | None = None) -> Pixels:
    """Decode the picture at ``path``, upright, no side longer than ``longest``.

    Raises ``PictureError`` when it is not a sane PNG or JPEG.

    Every picture that comes from outside goes through here: the limits of what is read are ``MAX_BYTES`` and
    ``structs.states.MAX_PIXELS``.
    """
    return _decoded(path, Image(path), longest)


def _decoded(path: Path, image: Image, longest: int | None) -> Pixels:
    try:
        with path.open("rb") as file:
            start = file.read(len(PNG_START))
        length = path.stat().st_size
    except OSError as error:
        raise PictureError(f"{path}: cannot be read ({error.strerror})") from error
    if length > MAX_BYTES:
        raise PictureError(f"{path}: has {length} bytes; more than {MAX_BYTES} are not read")
    if not start.startswith((PNG_START, JPEG_START)):
        if not start:
            raise PictureError(f"{path}: is empty, neither PNG nor JPEG: it was not copied to its end; copy it again")
        raise PictureError(f"{path}: is neither PNG nor JPEG, whatever its name says; {how_to_convert(start)}")
    try:
        return image.pixels() if longest is None else image.reduced(longest)
    except PictureError:
        raise
    except Exception as error:  # the decoder fails in many ways on damaged files
        raise PictureError(f"{path}: cannot be read as a picture ({error})") from error


def how_to_convert(start: bytes) -> str:
    """What to do with a file that begins with ``start``, which is neither PNG nor JPEG."""
    if start[4:8] == b"ftyp":
        return "export it as JPEG (an iPhone takes JPEG with Settings > Camera > Formats > Most Compatible)"
    return "convert it"
