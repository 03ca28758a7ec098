"""Optional packages: imported where they are used, and asked for by name when they are absent."""

from __future__ import annotations

import json
import shlex
from functools import cache
from importlib import import_module
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit
from urllib.request import url2pathname

from pix2pred.system.errors import Pix2predError

_NAME = "pix2pred"


class MissingExtraError(Pix2predError, ImportError):
    """Something is not installed; the message says which command installs it."""


def optional(module: str, extra: str) -> Any:
    """The module called ``module``. Raises ``MissingExtraError`` naming the extra that brings it."""
    try:
        return import_module(module)
    except ImportError as error:
        raise MissingExtraError(
            f"{module.partition('.')[0]} is not installed ({error}); install it with: {install_command(extra)}"
        ) from error


def install_command(extra: str) -> str:
    """The command that installs ``extra`` the way this package was installed: from an index, a clone or a file."""
    return command_for(extra, _origin())


@cache
def _origin() -> str:
    """What the installer noted about where the package came from (PEP 610); empty for an index."""
    try:
        return distribution(_NAME).read_text("direct_url.json") or ""
    except PackageNotFoundError:
        return ""


def command_for(extra: str, origin: str) -> str:
    """The command for a package whose origin is noted as ``origin``, a document of PEP 610 or nothing."""
    wanted = f"{_NAME}[{extra}]"
    try:
        document = json.loads(origin) if origin else {}
        url, folder, repository = document.get("url", ""), document.get("dir_info"), document.get("vcs_info")
    except (ValueError, AttributeError):
        url, folder, repository = "", None, None
    if not url:
        return f"pip install '{wanted}'"
    if folder is not None:
        place = Path(url2pathname(unquote(urlsplit(url).path)))
        shown = "." if Path.cwd() == place else str(place)
        flag = "-e " if isinstance(folder, dict) and folder.get("editable") else ""
        return f"pip install {flag}{_quoted(f'{shown}[{extra}]')}"
    if isinstance(repository, dict):
        revision = repository.get("requested_revision")
        url = f"{repository.get('vcs', 'git')}+{url}" + (f"@{revision}" if revision else "")
    return f"pip install {_quoted(f'{wanted} @ {url}')}"


def _quoted(text: str) -> str:
    """``text`` in quotes, which brackets need in some shells."""
    return shlex.quote(text)
