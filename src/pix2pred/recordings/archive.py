"""Folders out of one small file: a tar archive packed by LZMA, as ``tools/pack_recording.py`` makes it.

Pictures of one camera repeat most of their pixels. PNG files hide that, because each packs its own pixels, so they are
archived with their pixels stored plainly and packed again when they are taken out; no pixel changes.
"""

from __future__ import annotations

import io
import lzma
import tarfile
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from pix2pred.structs import Image
from pix2pred.system.files import write_whole


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
