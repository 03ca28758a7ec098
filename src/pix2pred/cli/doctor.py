"""``doctor``: what is installed, which providers have keys, whether a model answers and whether rendering works."""

from __future__ import annotations

import platform
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Annotated

import numpy as np
from cyclopts import Parameter

from pix2pred import __version__
from pix2pred.cli.console import out, plain, print_json
from pix2pred.images import ShownPictures
from pix2pred.registry import Registry
from pix2pred.structs import Box, Image, Picture
from pix2pred.structs.views import View
from pix2pred.system.errors import Pix2predError
from pix2pred.system.extras import install_command
from pix2pred.vlm import AnswerStore, FlowSettings
from pix2pred.vlm.answers.replay import replayed
from pix2pred.vlm.checkup import check

_PACKAGES = {
    "": ("pydantic-ai-slim", "openai", "genai-prices", "numpy", "pillow", "scikit-learn"),
    "[anthropic]": ("anthropic",),
    "[google]": ("google-genai",),
    "[sim]": ("mujoco",),
    "[torch]": ("torch",),
    "[planners]": ("unified-planning",),
}
"""Packages that are looked for, by the extra that brings them; those of the core come with pix2pred itself."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was looked at; ``ok`` is ``None`` for what is merely not there."""

    what: str
    ok: bool | None
    detail: str


def doctor(
    *,
    vlm: Annotated[
        str | None, Parameter(help="Also ask this model at most six questions; a paid model costs a few cents.")
    ] = None,
    json: Annotated[bool, Parameter(help="Print one JSON object on the last line.")] = False,
    registry: Annotated[Registry, Parameter(parse=False)],
) -> int:
    """Say what is installed, which providers have keys (never the keys), and whether models and rendering work.

    For example:

    - `pix2pred doctor --vlm openai:gpt-4o`
    """
    findings = [*_installed(), *_keys(registry), _rendering(registry), *(_model(registry, vlm) if vlm else ())]
    if json:
        print_json({"findings": [{"what": f.what, "ok": f.ok, "detail": f.detail} for f in findings]})
    else:
        signs = {True: "ok", None: "--", False: "NO"}
        for finding in findings:
            out.print(f"{signs[finding.ok]:<3}{finding.what:<27} {finding.detail}", markup=False, soft_wrap=True)
    return 1 if any(f.ok is False for f in findings) else 0


def _installed() -> Iterator[Finding]:
    yield Finding("pix2pred", True, f"{__version__} with Python {platform.python_version()} on {sys.platform}")
    for extra, packages in _PACKAGES.items():
        for name in packages:
            what = f"{name} {extra or 'core'}"
            try:
                yield Finding(what, True, version(name))
            except PackageNotFoundError:
                install = install_command(extra.strip("[]")) if extra else "reinstall pix2pred"
                yield Finding(what, None if extra else False, f"not installed ({install})")


def _keys(registry: Registry) -> Iterator[Finding]:
    for provider in registry.providers():
        has = provider.key() is not None
        what = "is set" if has else f"set {provider.keys_in_words}"
        yield Finding(f"key for {provider.name}", True if has else None, what)


def _rendering(registry: Registry) -> Finding:
    try:
        task = registry.domain("burger").tasks("more-stacks", 0, 1)[0].task
        picture = task.initial.pictures[0]
        size = len(ShownPictures()(View(picture, 0, heading="state 0")))
    except Exception as error:  # a report of what does not work ends with no traceback
        return Finding("rendering", False, f"{type(error).__name__}: {error}")
    return Finding("rendering", True, f"a burger scene with marks and heading, {size} bytes of PNG")


def _model(registry: Registry, spec: str) -> Iterator[Finding]:
    """What a few cheap questions to the model find out. A mailbox is looked at and asked nothing: a person answers."""
    flow = FlowSettings(tries=3, timeout=60.0, longest_pause=3.0, max_wait=60.0)
    try:
        named = registry.model_spec(spec)
        if known := named.known():
            yield Finding(spec.partition(",")[0], True, plain(known))
            if named.asks_the_rest:
                yield from _model(registry, spec.partition(",")[2])
            return
        if named.waits_in is not None:
            yield Finding(spec, *_mailbox(named.waits_in))
            return
        if named.own_answers is not None:
            yield Finding(spec, *_replay(named.own_answers))
            return
        model = registry.vlm(spec, None, flow)
    except Pix2predError as error:
        yield Finding(spec, False, plain(str(error)))
        return
    views = [View(_square(color, name), t, heading=f"state {t}") for t, (color, name) in enumerate(_SQUARES)]
    traits = list(check(model, views))
    for trait in traits:  # whether it answers at all comes first
        yield Finding(spec if trait is traits[0] else f"  {trait.what}", trait.ok, plain(trait.detail))
    if settings := [trait.setting for trait in traits if trait.setting]:
        yield Finding("  settings that follow", None, "; ".join(settings))


def _mailbox(folder: Path) -> tuple[bool, str]:
    """Whether questions can be put into the folder, and how many wait there."""
    if folder.exists() and not folder.is_dir():
        return False, f"{folder} is a file, not a folder"
    waiting = len(list(folder.glob("*/request.json"))) if folder.is_dir() else 0
    there = f"{waiting} questions wait in it" if folder.is_dir() else "the folder will be made"
    return True, f"a person answers here, so nothing was asked; {there}"


def _replay(folder: Path) -> tuple[bool, str]:
    """Which model's answers the folder holds."""
    if not folder.is_dir():
        return False, f"there is no folder {folder}; name a run folder, or an unpacked copy of its answers"
    store = AnswerStore(folder)
    name = replayed(store).name
    return True, f"{len(store.all_keys())} answers of {plain(name)}; nothing was asked"


_SQUARES = (((200, 30, 30), "red"), ((30, 30, 200), "blue"))


def _square(color: tuple[int, int, int], name: str) -> Picture:
    pixels = np.full((128, 128, 3), 235, dtype=np.uint8)
    pixels[32:96, 32:96] = color
    return Picture(name, Image.from_pixels(pixels), {"square": Box(32.0, 32.0, 96.0, 96.0)})
