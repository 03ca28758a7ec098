"""Photos as cameras leave them, for tests: with a time, a place, an owner and an orientation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import PIL.Image
from PIL.ExifTags import GPS, IFD, Base

SECRET = "Ada Lovelace"


def photo(
    path: Path,
    *,
    seed: int = 0,
    size: tuple[int, int] = (160, 120),
    time: str | None = None,
    offset: str | None = None,
    orientation: int = 1,
) -> Path:
    """A JPEG (or PNG) of coloured areas; ``seed`` decides which. ``offset`` is that of the camera's time zone."""
    rng = np.random.default_rng(seed)
    areas = rng.integers(0, 255, (6, 8, 3), dtype=np.uint8)
    image = PIL.Image.fromarray(areas).resize(size, PIL.Image.Resampling.NEAREST)
    exif = PIL.Image.Exif()
    exif[Base.Orientation] = orientation
    exif[Base.Artist] = SECRET
    exif[Base.ImageDescription] = SECRET
    exif.get_ifd(IFD.GPSInfo)[GPS.GPSLatitude] = (52.0, 30.0, 59.0)
    if time:
        exif.get_ifd(IFD.Exif)[Base.DateTimeOriginal] = time
    if offset:
        exif.get_ifd(IFD.Exif)[Base.OffsetTimeOriginal] = offset
    path.parent.mkdir(parents=True, exist_ok=True)
    image.save(path, exif=exif)
    return path
