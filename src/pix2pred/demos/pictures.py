"""Finding the pictures of a state, and looking into them."""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pix2pred.demos.documents import CAMERA_PATTERN, Sheet
from pix2pred.demos.folders import entries, is_folder, refusal
from pix2pred.demos.problems import Problem
from pix2pred.demos.yaml_lines import Loc
from pix2pred.structs import Box, Image, PictureError

ENDINGS = (".png", ".jpg", ".jpeg")
_OTHER_PICTURES = (".bmp", ".gif", ".heic", ".heif", ".tif", ".tiff", ".webp")
MAX_BYTES = 100_000_000

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
        elif strict and ending in _OTHER_PICTURES:
            found.append(Problem(folder, None, f"{path.name!r}: only PNG and JPEG are read; convert the picture"))
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
class Size:
    """Extent of a picture in pixels."""

    width: int
    height: int

    def __str__(self) -> str:
        return f"{self.width}x{self.height}"


@dataclass(slots=True)
class PictureCheck:
    """Decodes the pictures of one demonstration and compares what it sees."""

    sheet: Sheet
    sizes: dict[str, Size] = field(default_factory=dict)

    def look(self, camera: str, path: Path, boxes: Mapping[str, Box], loc: Loc) -> None:
        """Report a picture that cannot be read, has another size than before, or boxes that leave it."""
        try:
            size = measure(path)
        except PictureError as error:
            self.sheet.found.append(Problem(path, None, str(error).removeprefix(f"{path}: ")))
            return
        first = self.sizes.setdefault(camera, size)
        if size != first:
            message = f"is {size} pixels, earlier pictures of camera {camera!r} are {first}; use one size"
            self.sheet.found.append(Problem(path, None, message))
        for name, box in boxes.items():
            if box.left < 0 or box.top < 0 or box.right > size.width or box.bottom > size.height:
                self.sheet.report((*loc, name), f"the box of {name!r} leaves the picture, which is {size} pixels")


def measure(path: Path) -> Size:
    """Decode the picture at ``path`` whole. Raises ``PictureError`` when it is not a sane PNG or JPEG."""
    try:
        with path.open("rb") as file:
            start = file.read(len(PNG_START))
        length = path.stat().st_size
    except OSError as error:
        raise PictureError(f"{path}: cannot be read ({error.strerror})") from error
    if length > MAX_BYTES:
        raise PictureError(f"{path}: has {length} bytes; more than {MAX_BYTES} are not read")
    if not start.startswith((PNG_START, JPEG_START)):
        raise PictureError(f"{path}: is neither PNG nor JPEG, whatever its name says; convert it")
    try:
        height, width = Image(path).pixels().shape[:2]
    except PictureError:
        raise
    except Exception as error:  # the decoder fails in many ways on damaged files
        raise PictureError(f"{path}: cannot be read as a picture ({error})") from error
    return Size(width, height)
