"""What to type to get an extra, by how the package was installed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from pix2pred.system.extras import command_for


@pytest.mark.parametrize(
    ("origin", "command"),
    [
        ("", "pip install 'pix2pred[sim]'"),
        ("{", "pip install 'pix2pred[sim]'"),
        ("[]", "pip install 'pix2pred[sim]'"),
        (json.dumps({"url": "file:///src/pix", "dir_info": {"editable": True}}), "pip install -e '/src/pix[sim]'"),
        (json.dumps({"url": "file:///a%20b", "dir_info": {}}), "pip install '/a b[sim]'"),
        (
            json.dumps({"url": "file:///x/pix2pred-1-py3-none-any.whl", "archive_info": {}}),
            "pip install 'pix2pred[sim] @ file:///x/pix2pred-1-py3-none-any.whl'",
        ),
        (
            json.dumps({"url": "https://h/r", "vcs_info": {"vcs": "git", "requested_revision": "v1"}}),
            "pip install 'pix2pred[sim] @ git+https://h/r@v1'",
        ),
    ],
)
def test_an_extra_is_installed_as_the_package_was(origin: str, command: str) -> None:
    assert command_for("sim", origin) == command


def test_within_the_clone_the_command_is_short(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    origin = json.dumps({"url": tmp_path.as_uri(), "dir_info": {"editable": True}})
    assert command_for("sim", origin) == "pip install -e '.[sim]'"
