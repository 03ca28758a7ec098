"""JSON Schemas of the files a person or another program writes, so that editors complete and check them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from pix2pred.demos.files.documents import DemoDoc, DomainDoc, FileDoc, TaskDoc
from pix2pred.demos.files.sidecar import ImportDoc
from pix2pred.structs.formats.traces import TracesDoc
from pix2pred.system.files import write_whole

SCHEMAS = "schemas"
"""The folder beside ``domain.yaml`` in which ``init`` puts them."""

DIALECT = "https://json-schema.org/draft/2020-12/schema"

_DOCUMENTS: dict[str, type[FileDoc]] = {"domain": DomainDoc, "demo": DemoDoc, "task": TaskDoc, "import": ImportDoc}


def json_schemas() -> dict[str, dict[str, Any]]:
    """The schema of each kind of file, by file name: ``domain.schema.json`` is that of ``domain.yaml``."""
    written = {f"{kind}.yaml": document.model_json_schema() for kind, document in _DOCUMENTS.items()}
    written["traces.json"] = TracesDoc.model_json_schema()
    return {
        f"{name.partition('.')[0]}.schema.json": {"$schema": DIALECT, **schema, "title": f"pix2pred {name}"}
        for name, schema in written.items()
    }


def write_schemas(folder: Path) -> tuple[Path, ...]:
    """Write every schema into ``folder``; gives the files."""
    files = []
    for name, schema in json_schemas().items():
        text = json.dumps(schema, indent=1, ensure_ascii=False) + "\n"
        write_whole(folder / name, text.encode())
        files.append(folder / name)
    return tuple(files)


def schema_line(kind: str, up: str = "") -> str:
    """The comment that tells editors where the schema of a ``kind`` of file is; ``up`` leads to the project folder."""
    return f"# yaml-language-server: $schema={up}{SCHEMAS}/{kind}.schema.json\n"
