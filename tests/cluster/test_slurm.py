"""The recipe of docs/cluster.md, submitted to a real Slurm."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from cluster.slurm import slurm
from doc_runner import SavedFile, parts
from extras import need

pytestmark = need("dask", "distributed", extra="dask")

PAGE = Path(__file__).parents[2] / "docs/cluster.md"
SUITE = """\
name: small
about: two tasks of a kitchen
approaches: [ours]
families: [{name: kitchen, domain: kitchen}]
seeds: [0]
tasks: 2
"""


def test_a_suite_run_by_slurm_has_the_rows_of_one_run_here(tmp_path: Path) -> None:
    recipe = next(p for p in parts(PAGE.read_text()) if isinstance(p, SavedFile))
    work = tmp_path / "work"
    work.mkdir()
    (work / recipe.name).write_text(recipe.content)
    (work / "small.yaml").write_text(SUITE)
    (tmp_path / "slurm").mkdir()
    programs = Path(sys.executable).parent
    with slurm(tmp_path / "slurm") as environment:
        environment["PATH"] = f"{programs}:{environment['PATH']}"
        job = ["sbatch", "--wait", "--ntasks=2", recipe.name, "bench", "run", "small.yaml", "--out", "theirs"]
        ended = subprocess.run(job, cwd=work, env=environment, capture_output=True, text=True, timeout=600)
        log = work / "bench.log"
        assert ended.returncode == 0, (ended.stderr, log.read_text() if log.exists() else "no log")
    here = ["pix2pred", "bench", "run", "small.yaml", "--out", "ours"]
    subprocess.run(here, cwd=work, env=environment, check=True, capture_output=True, timeout=600)
    rows = (work / "ours/rows.jsonl").read_bytes()
    assert rows and (work / "theirs/rows.jsonl").read_bytes() == rows
