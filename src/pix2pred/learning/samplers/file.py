"""Learned samplers on disk: one npz of plain arrays, never pickled, with the boxes and the kinds of estimators."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from pix2pred.learning.samplers.learn import CHOICES, KernelValidity, LearnedSampler, LinearGaussian
from pix2pred.learning.samplers.networks import NetworkGaussian, NetworkValidity
from pix2pred.structs.samplers import Sampler
from pix2pred.system.errors import Pix2predError

VERSION = 2
_BOX = ("low", "high")


class SamplerFileError(Pix2predError, ValueError):
    """A file that is not one of samplers that this program reads."""


def dump_samplers(samplers: Mapping[str, Sampler]) -> bytes:
    """The content of the file; equal samplers give equal bytes."""
    arrays: dict[str, Any] = {"version": np.array(VERSION)}
    for operator, sampler in sorted(samplers.items()):
        assert isinstance(sampler, LearnedSampler), f"{operator}: only learned samplers are saved"
        parts = {"low": np.array(sampler.low), "high": np.array(sampler.high)}
        parts |= {f"gaussian|{k}": v for k, v in sampler.gaussian.arrays().items()}
        if sampler.validity is not None:
            parts |= {f"validity|{k}": v for k, v in sampler.validity.arrays().items()}
        arrays |= {f"{operator}|{sampler.name}|{key}": value for key, value in parts.items()}
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:  # np.savez would store the time of writing
        for key, value in sorted(arrays.items()):
            member = io.BytesIO()
            np.lib.format.write_array(member, np.asarray(value), allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{key}.npy", (1980, 1, 1, 0, 0, 0)), member.getvalue())
    return buffer.getvalue()


def load_samplers(path: Path) -> dict[str, Sampler]:
    """Samplers by operator. Raises ``SamplerFileError`` for anything that is no such file."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {key: file[key] for key in file.files}
        if int(arrays.pop("version")) != VERSION:
            raise ValueError("another version")
        grouped: dict[tuple[str, str], dict[str, Any]] = {}
        for key, value in arrays.items():
            operator, name, part = key.split("|", 2)
            grouped.setdefault((operator, name), {})[part] = value
        return {operator: _build(name, parts) for (operator, name), parts in grouped.items()}
    except (OSError, EOFError, ValueError, KeyError, TypeError, zipfile.BadZipFile) as error:
        raise SamplerFileError(f"{path}: cannot be read as samplers ({error}); learn the model again") from error


def _build(name: str, parts: Mapping[str, Any]) -> LearnedSampler:
    def part(prefix: str) -> dict[str, Any]:
        return {key.removeprefix(prefix): value for key, value in parts.items() if key.startswith(prefix)}

    gaussian, validity = part("gaussian|"), part("validity|")
    low, high = (tuple(float(v) for v in parts[key]) for key in _BOX)
    if name == "torch":
        networks = NetworkValidity.of(validity) if validity else None
        return LearnedSampler(name, NetworkGaussian.of(gaussian), networks, low, high)
    return LearnedSampler(
        name, LinearGaussian(**gaussian), KernelValidity(**validity) if validity else None, low, high, CHOICES
    )
