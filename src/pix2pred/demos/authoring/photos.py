"""Photos as a camera leaves them: found in folders, put in order, and copied without what they tell of their maker."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from itertools import groupby
from pathlib import Path
from typing import Any, BinaryIO, Literal

from joblib import Parallel, delayed
from PIL.ExifTags import IFD, Base
from PIL.JpegImagePlugin import JpegImageFile
from PIL.PngImagePlugin import PngImageFile

from pix2pred.demos.files.folders import entries, is_folder, refusal
from pix2pred.demos.files.problems import FolderError, Problem
from pix2pred.demos.files.sidecar import demo_name
from pix2pred.demos.photos.copies import clean_copy, first_bytes
from pix2pred.demos.photos.heic import HEIC_ENDINGS, is_heic, open_heic
from pix2pred.demos.pictures import ENDINGS, OTHER_PICTURES, PNG_START, how_to_convert
from pix2pred.structs import Image, PictureError

MAIN = "main"
"""The name of the only camera."""

_MOST_WORKERS = 4
"""Threads that copy photos: each holds one, which is up to 0.2 GB while it is unpacked."""

_TIME = "%Y:%m:%d %H:%M:%S"
_OFFSET = re.compile(r"([-+])(\d{2}):?(\d{2})", re.ASCII)

Order = Literal["auto", "time", "name"]
"""By the time in the photo, by file name, or by time where every photo of a demonstration has one."""


@dataclass(frozen=True, slots=True)
class PhotoSeries:
    """The photos of one demonstration in order, by camera; ``note`` says what the order rests on."""

    name: str
    folder: Path
    cameras: Mapping[str, tuple[Path, ...]]
    note: str

    def __len__(self) -> int:
        return len(next(iter(self.cameras.values())))


def find_photos(source: Path, order: Order = "auto") -> tuple[PhotoSeries, ...]:
    """The series in ``source``: one for each sub-folder, or one when the photos lie in ``source`` itself.

    A sub-folder may hold photos, or a folder of photos for each camera, or a numbered folder with one photo for each
    state. Raises ``FolderError`` with every problem.
    """
    if not is_folder(source):
        what = "is not a folder" + ("; unpack it first" if source.suffix.lower() in (".zip", ".tar", ".gz") else "")
        raise FolderError.about(source, what if source.exists() else "does not exist")
    found: list[Problem] = []
    flat = _photos(source, source, found)
    folders = [path for path in entries(source, found) if is_folder(path)]
    series: list[PhotoSeries] = []
    if flat and any(_photos(f, source, []) for f in folders):
        raise FolderError.about(
            source, "holds photos and folders of photos; move the photos into a folder of their own"
        )
    if not flat and (states := _numbered(source, source)):
        flat = states
    for folder in [source] if flat else folders:
        cameras = {MAIN: flat} if flat else _cameras(folder, source, found)
        if cameras:
            series.append(
                _in_order(folder, cameras, order, demo_name(folder.resolve().name, [s.name for s in series]), found)
            )
    if not series and not found:
        found.append(Problem(source, None, "holds no photo (PNG or JPEG), nor a folder of photos"))
    if found:
        raise FolderError(found)
    return tuple(series)


def _numbered(folder: Path, root: Path) -> list[Path]:
    """The photos of numbered states: ``0/a.jpg``, ``1/b.jpg``, and so on; none unless each folder holds one photo."""
    states = [path for path in entries(folder, []) if is_folder(path)]
    photos = [_photos(state, root, []) for state in states]
    if [s.name for s in states] != [str(t) for t in range(len(states))] or any(len(p) != 1 for p in photos):
        return []
    return [path for (path,) in photos]


def _photos(folder: Path, root: Path, found: list[Problem]) -> list[Path]:
    """The photos in ``folder``; those that cannot be read, by their names, are problems."""
    photos = []
    for path in entries(folder, found):
        ending = path.suffix.lower()
        if is_folder(path):
            continue
        if ending in (*ENDINGS, *HEIC_ENDINGS):
            if message := refusal(path, root, "folder of photos"):
                found.append(Problem(path, None, message))
            else:
                photos.append(path)
        elif ending in OTHER_PICTURES:
            found.append(Problem(path, None, f"only PNG, JPEG and HEIC are read; {how_to_convert(b'')}"))
    return photos


def _cameras(folder: Path, root: Path, found: list[Problem]) -> dict[str, list[Path]]:
    """The photos of a demonstration by camera."""
    if photos := _photos(folder, root, found) or _numbered(folder, root):
        return {MAIN: photos}
    cameras: dict[str, list[Path]] = {}
    for inner in (path for path in entries(folder, found) if is_folder(path)):
        if photos := _photos(inner, root, found):
            cameras[demo_name(inner.name.replace(".", "_"), list(cameras))] = photos
    if not cameras:
        found.append(Problem(folder, None, "holds no photo (PNG or JPEG); remove the folder or put photos in"))
    elif len({len(photos) for photos in cameras.values()}) > 1:
        counts = ", ".join(f"{name}: {len(photos)}" for name, photos in cameras.items())
        found.append(Problem(folder, None, f"the cameras have different numbers of photos ({counts})"))
        return {}
    return cameras


def _in_order(
    folder: Path, cameras: Mapping[str, list[Path]], order: Order, name: str, found: list[Problem]
) -> PhotoSeries:
    photos = [path for paths in cameras.values() for path in paths]
    if len(next(iter(cameras.values()))) < 2:
        found.append(Problem(folder, None, "holds one photo; a demonstration needs one before and one after each step"))
    times = {} if order == "name" else {path: time for path in photos if (time := taken_at(path))}
    if order == "time":
        missing = [path for path in photos if path not in times]
        found += [Problem(path, None, "says no time it was taken; order by name instead") for path in missing]
    by_time = bool(times) and len(times) == len(photos)
    zoned = all(time.offset is not None for time in times.values())  # else the clocks of the cameras are compared
    note = "in the order of the times they were taken" if by_time else "in the order of their names"
    if times and not by_time:
        note += f"; {len(photos) - len(times)} of {len(photos)} say no time they were taken"
    if not by_time:
        return PhotoSeries(name, folder, {c: tuple(paths) for c, paths in cameras.items()}, note)
    moments = {path: time.moment(zoned=zoned) for path, time in times.items()}
    ordered = {c: tuple(sorted(paths, key=moments.__getitem__)) for c, paths in cameras.items()}  # stable: then by name
    return PhotoSeries(name, folder, ordered, note)


@dataclass(frozen=True, slots=True)
class TakenAt:
    """When a photo was taken, by the clock of its camera; ``offset`` is how far that was ahead of UTC, if it says."""

    local: datetime
    fraction: str
    offset: timedelta | None

    def moment(self, *, zoned: bool) -> tuple[datetime, str]:
        """What photos are ordered by: the time in UTC when ``zoned``, else the camera's own."""
        ahead = self.offset if zoned and self.offset is not None else timedelta()
        return self.local - ahead, self.fraction


def taken_at(path: Path) -> TakenAt | None:
    """When the photo was taken, to the fraction of a second its camera noted; None when it does not say."""
    try:
        with path.open("rb") as file, _opened(path, file) as opened:
            exif = opened.getexif()
            noted = exif.get_ifd(IFD.Exif)
        text = noted.get(Base.DateTimeOriginal) or exif.get(Base.DateTime)
        ahead = noted.get(Base.OffsetTimeOriginal) if noted.get(Base.DateTimeOriginal) else noted.get(Base.OffsetTime)
        local = datetime.strptime(str(text).strip("\0 "), _TIME)
        return TakenAt(local, str(noted.get(Base.SubsecTimeOriginal, "")), _offset(str(ahead or "")))
    except Exception:  # no time, or a damaged file: that is said when its pixels are read
        return None


def _opened(path: Path, file: BinaryIO) -> Any:
    start = first_bytes(path)
    return open_heic(path) if is_heic(start) else (PngImageFile if start.startswith(PNG_START) else JpegImageFile)(file)


def _offset(text: str) -> timedelta | None:
    """How far ``+02:00`` is ahead of UTC; None for anything else."""
    match = _OFFSET.fullmatch(text.strip("\0 "))
    if match is None:
        return None
    ahead = timedelta(hours=int(match[2]), minutes=int(match[3]))
    return -ahead if match[1] == "-" else ahead


def clean_copies(series: PhotoSeries, max_side: int, found: list[Problem]) -> Iterator[Mapping[str, Image]]:
    """The photos of each state by camera: upright, at most ``max_side`` long, without any metadata.

    What cannot be read goes to ``found``, and its state lacks that camera.
    """
    workers = min(_MOST_WORKERS, os.cpu_count() or 1)
    work = Parallel(n_jobs=workers, prefer="threads", return_as="generator")  # a few photos ahead of the one asked for
    places = [(t, camera, paths[t]) for t in range(len(series)) for camera, paths in series.cameras.items()]
    copies = work(delayed(_clean_copy_or_error)(path, max_side) for _, _, path in places)
    for _, state in groupby(zip(places, copies, strict=True), key=lambda item: item[0][0]):
        images: dict[str, Image] = {}
        for (_, camera, path), copy in state:
            if isinstance(copy, Image):
                images[camera] = copy
            else:
                found.append(Problem(path, None, str(copy).removeprefix(f"{path}: ")))
        yield images


def _clean_copy_or_error(path: Path, max_side: int) -> Image | PictureError:
    try:
        return clean_copy(path, max_side)
    except PictureError as error:
        return error
