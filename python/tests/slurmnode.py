# SPDX-License-Identifier: Apache-2.0
"""A Slurm of one node, this machine, for as long as a test lasts. It needs neither
root nor cgroups, and touches no Slurm that is configured here."""

from __future__ import annotations

import contextlib
import getpass
import os
import secrets
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

DAEMONS = ("munged", "slurmctld", "slurmd")
PATH = f"{os.environ.get('PATH', '')}:/usr/sbin:/usr/local/sbin"

CONFIG = """ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={control}
SlurmdPort={node}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,batch_sched_delay=0
MpiDefault=none
MailProg=/bin/true
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=test Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def missing() -> str:
    """Says which program is not installed; empty where all are."""
    wanted = (*DAEMONS, "sbatch", "scancel", "sinfo", "squeue")
    return ", ".join(name for name in wanted if not shutil.which(name, path=PATH))


def _ports() -> tuple[int, int]:
    with socket.socket() as a, socket.socket() as b:
        a.bind(("127.0.0.1", 0))
        b.bind(("127.0.0.1", 0))
        return a.getsockname()[1], b.getsockname()[1]


def _commands(folder: Path) -> Iterator[list[str]]:
    key = folder / "key-file"
    key.write_bytes(secrets.token_bytes(1024))
    key.chmod(0o400)
    names = ("key-file", "socket", "pid-file", "seed-file")
    options = [f"--{name}={folder / name}" for name in names]
    yield ["munged", "--foreground", "--force", "--num-threads=2", *options]
    yield ["slurmctld", "-D", "-c"]
    yield ["slurmd", "-D"]


@contextlib.contextmanager
def node(folder: Path, cpus: int) -> Iterator[dict[str, str]]:
    """Runs the daemons, and gives the variables with which Slurm's programs find
    them. A RuntimeError, with the daemons' words, if the node is not ready."""
    control, port = _ports()
    config = folder / "slurm.conf"
    for name in ("state", "spool"):
        (folder / name).mkdir(parents=True)
    text = CONFIG.format(
        folder=folder,
        host=socket.gethostname().split(".")[0],
        user=getpass.getuser(),
        control=control,
        node=port,
        cpus=cpus,
    )
    config.write_text(text)
    found = {"SLURM_CONF": str(config), "PATH": PATH}
    running: list[subprocess.Popen[bytes]] = []
    log = folder / "daemons.log"
    try:
        with log.open("wb") as out:
            for command in _commands(folder):
                running.append(
                    subprocess.Popen(
                        [shutil.which(command[0], path=PATH) or "", *command[1:]],
                        env={**os.environ, **found},
                        stdout=out,
                        stderr=subprocess.STDOUT,
                    )
                )
                time.sleep(0.5)
        _wait(found, log)
        yield found
    finally:
        for process in reversed(running):
            process.terminate()
            process.wait(30)


def _wait(found: dict[str, str], log: Path) -> None:
    """Waits until the node takes jobs."""
    command = [shutil.which("sinfo", path=PATH) or "", "-h", "-o", "%t"]
    end = time.monotonic() + 60
    while time.monotonic() < end:
        told = subprocess.run(
            command, env={**os.environ, **found}, capture_output=True, text=True
        )
        if told.stdout.strip() == "idle":
            return
        time.sleep(0.5)
    raise RuntimeError(f"no node of Slurm is ready:\n{log.read_text()[-3000:]}")
