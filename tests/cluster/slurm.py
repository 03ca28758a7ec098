"""A real Slurm of one node on this machine, whose files are in a folder and whose daemons end with the test."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

_CONFIGURATION = """\
ClusterName=here
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={processors} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


@contextmanager
def slurm(folder: Path, processors: int = 2) -> Iterator[dict[str, str]]:
    """The environment in which ``sbatch`` and its siblings find the cluster."""
    missing = [p for p in ("munged", "slurmctld", "slurmd", "sbatch") if shutil.which(p, path=_PATH) is None]
    assert not missing, f"this test runs {', '.join(missing)}; install slurm-wlm, e.g. apt-get install slurm-wlm"
    folder.chmod(0o711)
    for name in ("state", "spool"):
        (folder / name).mkdir()
    key = folder / "munge.key"
    key.write_bytes(os.urandom(64))
    key.chmod(0o400)
    configuration = folder / "slurm.conf"
    user = subprocess.run(["id", "-un"], capture_output=True, text=True, check=True).stdout.strip()
    host = socket.gethostname().partition(".")[0]
    text = _CONFIGURATION.format(host=host, user=user, folder=folder, processors=processors, ports=_free_ports(2))
    configuration.write_text(text)
    environment = {**os.environ, "PATH": _PATH, "SLURM_CONF": str(configuration)}
    authenticate = ["--key-file", str(key), "--socket", str(folder / "munge.socket")]
    places = [f"--{n}-file={folder / f'munge.{n}'}" for n in ("pid", "log", "seed")]
    with ExitStack() as daemons:
        for command in (
            ["munged", "--foreground", "--force", *authenticate, *places],
            ["slurmctld", "-D", "-f", str(configuration), "-L", str(folder / "slurmctld.log")],
            ["slurmd", "-D", "-f", str(configuration), "-L", str(folder / "slurmd.log")],
        ):
            daemons.enter_context(_running(command, environment))
        yield environment


_PATH = os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/sbin"])


@contextmanager
def _running(command: list[str], environment: dict[str, str]) -> Iterator[None]:
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield
    finally:
        process.terminate()
        process.wait(60)


def _free_ports(number: int) -> list[int]:
    with ExitStack() as held:
        sockets = [held.enter_context(socket.socket()) for _ in range(number)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]
