"""Folders as one small file: a tar archive packed by LZMA, the same bytes for the same files.

Pictures of one camera repeat most of their pixels. PNG files hide that, because each packs its own pixels, so they are
archived with their pixels stored plainly and packed again when they are taken out; no pixel changes.
"""

from __future__ import annotations

import io
import lzma
import tarfile
from collections.abc import Iterable, Iterator
from pathlib import Path, PurePosixPath

import PIL.Image

from pix2pred.structs import Image
from pix2pred.system.files import write_whole

PRESET = 9 | lzma.PRESET_EXTREME
"""LZMA's largest dictionary (64 MiB): a repeated background is found whatever lies between its two pictures."""


def pack_folder(folder: Path, names: Iterable[str], archive: Path) -> None:
    """Write the files ``names`` of ``folder`` into ``archive``, in sorted order and without dates or owners."""
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w", format=tarfile.USTAR_FORMAT) as tar:
        for name in sorted(names):
            content = (folder / name).read_bytes()
            if name.endswith(".png"):
                content = _stored_plainly(content)
            entry = tarfile.TarInfo(name)
            entry.size = len(content)
            tar.addfile(entry, io.BytesIO(content))
    write_whole(archive, lzma.compress(packed.getvalue(), preset=PRESET))


def unpack_folder(archive: Path, folder: Path) -> None:
    """Write every file of ``archive`` below ``folder``; files that are there already are replaced.

    Raises ``ValueError`` for an entry that is no plain file or would lie outside ``folder``.
    """
    for name, content in _entries(archive):
        path = PurePosixPath(name)
        if path.is_absolute() or ".." in path.parts:
            raise ValueError(f"{archive}: {name} would lie outside the folder it is unpacked into")
        if path.suffix == ".png":
            content = Image.from_pixels(Image(content).pixels()).encoded
        write_whole(folder / path, content)


def _entries(archive: Path) -> Iterator[tuple[str, bytes]]:
    with tarfile.open(fileobj=io.BytesIO(lzma.decompress(archive.read_bytes()))) as tar:
        for entry in tar:
            stream = tar.extractfile(entry)
            if stream is None:
                raise ValueError(f"{archive}: {entry.name} is no plain file")
            yield entry.name, stream.read()


def _stored_plainly(png: bytes) -> bytes:
    plain = io.BytesIO()
    PIL.Image.open(io.BytesIO(png)).convert("RGB").save(plain, "PNG", compress_level=0)
    return plain.getvalue()
