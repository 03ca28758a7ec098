"""Small videos and LeRobot datasets, made with the libraries of those formats."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image

from pix2pred.structs import Pixels

FPS = 10
SIZE = (64, 48)


def level(frame: int) -> int:
    """The grey of frame number ``frame``: every frame has its own."""
    return 20 + 5 * (frame % 45)


def frame_pixels(frame: int, size: tuple[int, int] = SIZE) -> Pixels:
    """A grey picture with a bright upper left corner."""
    pixels = np.full((size[1], size[0], 3), level(frame), np.uint8)
    pixels[: size[1] // 4, : size[0] // 4] = 255
    return pixels


def shown_frame(pixels: Pixels) -> int:
    """The number of the frame (of the first 45) that ``pixels`` show."""
    height, width = pixels.shape[:2]
    return round((float(pixels[height // 2 :, width // 2 :].mean()) - 20) / 5)


def write_video(path: Path, frames: int, *, size: tuple[int, int] = SIZE, faststart: bool = False) -> Path:
    """Frames at ``FPS``, a key frame every 12, each of its own grey."""
    import av

    path.parent.mkdir(parents=True, exist_ok=True)
    options = {"movflags": "faststart"} if faststart else {}
    with av.open(str(path), "w", options=options) as container:
        stream = container.add_stream("libx264", rate=FPS, options={"g": "12", "crf": "5"})
        stream.width, stream.height = size
        stream.pix_fmt = "yuv420p"
        for i in range(frames):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(frame_pixels(i, size), format="rgb24")))
        container.mux(stream.encode())
    return path


def write_dataset(root: Path, lengths: tuple[int, ...] = (15, 20), *, info: dict[str, Any] | None = None) -> Path:
    """A dataset with a camera kept as video and one kept as pictures in the table; all episodes in one file each."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    features = {
        "observation.images.front": {"dtype": "video", "shape": [SIZE[1], SIZE[0], 3], "names": None},
        "observation.images.wrist.cam": {"dtype": "image", "shape": [SIZE[1], SIZE[0], 3], "names": None},
        "observation.state": {"dtype": "float32", "shape": [2], "names": ["x", "y"]},
    }
    meta = {
        "codebase_version": "v3.0", "fps": FPS, "total_episodes": len(lengths), "features": features,
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4",
    }  # fmt: skip
    for folder in ("meta/episodes/chunk-000", "data/chunk-000"):
        (root / folder).mkdir(parents=True)
    (root / "meta/info.json").write_text(json.dumps(meta | (info or {})))
    rows, episodes, begin = [], [], 0
    for number, length in enumerate(lengths):
        for i in range(length):
            rows.append(
                {"episode_index": number, "frame_index": i, "index": begin + i, "timestamp": i / FPS,
                 "observation.state": [0.5, float(i)],
                 "observation.images.wrist.cam": {"bytes": _png(begin + i), "path": f"{i}.png"}}
            )  # fmt: skip
        episodes.append(
            {"episode_index": number, "tasks": [f"put cube {number} away"], "length": length,
             "dataset_from_index": begin, "dataset_to_index": begin + length,
             "data/chunk_index": 0, "data/file_index": 0,
             "videos/observation.images.front/chunk_index": 0, "videos/observation.images.front/file_index": 0,
             "videos/observation.images.front/from_timestamp": begin / FPS,
             "videos/observation.images.front/to_timestamp": (begin + length) / FPS}
        )  # fmt: skip
        begin += length
    pq.write_table(pa.Table.from_pylist(rows), root / "data/chunk-000/file-000.parquet")
    pq.write_table(pa.Table.from_pylist(episodes), root / "meta/episodes/chunk-000/file-000.parquet")
    write_video(root / "videos/observation.images.front/chunk-000/file-000.mp4", begin)
    return root


def _png(frame: int) -> bytes:
    buffer = io.BytesIO()
    PIL.Image.fromarray(frame_pixels(frame)).save(buffer, "PNG")
    return buffer.getvalue()


def sidecar(path: Path, *demos: dict[str, Any]) -> Path:
    """A side-car file (JSON is YAML)."""
    path.write_text(json.dumps({"format": "pix2pred-import", "version": 1, "demos": demos}, indent=1))
    return path


def write_v2_dataset(root: Path, lengths: tuple[int, ...] = (15, 20), *, chunks_size: int = 1000) -> Path:
    """The same camera kept as video in format v2.1: a table and a video for each episode."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    numbers = {name: {"dtype": "int64", "shape": [1]} for name in ("episode_index", "frame_index")}
    features = {"observation.images.front": {"dtype": "video", "shape": [SIZE[1], SIZE[0], 3]}, **numbers}
    meta = {"codebase_version": "v2.1", "fps": FPS, "chunks_size": chunks_size, "features": features}
    (root / "meta").mkdir(parents=True)
    (root / "meta/info.json").write_text(json.dumps(meta))
    lines = []
    for n, length in enumerate(lengths):
        lines.append(json.dumps({"episode_index": n, "tasks": [f"put cube {n} away"], "length": length}))
        chunk = f"chunk-{n // chunks_size:03d}"
        table = root / "data" / chunk / f"episode_{n:06d}.parquet"
        table.parent.mkdir(parents=True, exist_ok=True)
        pq.write_table(pa.Table.from_pylist([{"episode_index": n, "frame_index": i} for i in range(length)]), table)
        write_video(root / "videos" / chunk / "observation.images.front" / f"episode_{n:06d}.mp4", length)
    (root / "meta/episodes.jsonl").write_text("\n".join(lines) + "\n")
    return root


def rewrite(path: Path, change: Any) -> None:
    """The table at ``path`` with every row as ``change`` leaves it."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    pq.write_table(pa.Table.from_pylist([change(row) for row in pq.read_table(path).to_pylist()]), path)
