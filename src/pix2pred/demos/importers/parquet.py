"""Parquet tables read in small pieces: a file of some kilobytes may claim, or unpack to, any size."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from pix2pred.demos.files.folders import refusal
from pix2pred.demos.pictures import MAX_BYTES
from pix2pred.system.errors import Pix2predError
from pix2pred.system.extras import optional

MAX_ROWS = 10_000_000
"""Frames of one file: four days at 30 a second."""

MAX_UNPACKED = 2_000_000_000
"""Bytes of one column in one group of rows, unpacked: a group is read at once."""

_BATCH = 64


class ParquetError(Pix2predError, ValueError):
    """A table cannot be read; the message says why."""


def rows(path: Path, columns: Sequence[str], root: Path, batch: int = 4096) -> Iterator[dict[str, Any]]:
    """The rows of the table at ``path`` with the ``columns`` asked for. Raises ``ParquetError``.

    ``path`` must not lead out of ``root``.
    """
    if message := refusal(path, root, "source"):
        raise ParquetError(message)
    optional("pyarrow", "lerobot")
    import pyarrow
    import pyarrow.parquet

    try:
        with pyarrow.parquet.ParquetFile(path, memory_map=False, pre_buffer=False) as file:
            names = set(file.schema_arrow.names)
            if missing := [c for c in columns if c not in names]:
                raise ParquetError(f"has no column {missing[0]!r}; is it a LeRobot dataset of version 3?")
            _refuse_size(file.metadata, columns)
            for table in file.iter_batches(batch, columns=list(columns), use_threads=False):
                yield from table.to_pylist()
    except ParquetError:
        raise
    except (pyarrow.ArrowException, OSError, ValueError, MemoryError) as error:
        raise ParquetError(f"cannot be read as a Parquet table ({' '.join(str(error).split())[:200]})") from error


def _refuse_size(metadata: Any, columns: Sequence[str]) -> None:
    if metadata.num_rows > MAX_ROWS:
        raise ParquetError(f"claims {metadata.num_rows} rows; more than {MAX_ROWS} are not read")
    for g in range(metadata.num_row_groups):
        group = metadata.row_group(g)
        for c in range(group.num_columns):
            column = group.column(c)
            inside = column.path_in_schema
            wanted = any(inside == name or inside.startswith(f"{name}.") for name in columns)
            if wanted and column.total_uncompressed_size > MAX_UNPACKED:
                size = column.total_uncompressed_size
                raise ParquetError(f"column {inside!r} unpacks to {size} bytes; more than {MAX_UNPACKED} are not read")


def picture_rows(path: Path, key: str, wanted: Sequence[tuple[int, int]], root: Path) -> Iterator[bytes]:
    """The encoded pictures in column ``key`` of the frames ``wanted``, (episode, frame) in the order of the table."""
    pending = list(wanted)
    for row in rows(path, ("episode_index", "frame_index", key), root, _BATCH):
        if not pending:
            return
        if (row["episode_index"], row["frame_index"]) == pending[0]:
            pending.pop(0)
            cell = row[key]
            encoded = cell.get("bytes") if isinstance(cell, dict) else cell
            if not isinstance(encoded, bytes):
                raise ParquetError("holds no picture in the table; pictures in files of their own are not read")
            if len(encoded) > MAX_BYTES:
                raise ParquetError(f"has a picture of {len(encoded)} bytes; more than {MAX_BYTES} are not read")
            yield encoded
    if pending:
        raise ParquetError(f"has no frame {pending[0][1]} of episode {pending[0][0]}; the file may be cut off")
