"""A real Slurm of one node on this machine, from Debian's packages, for the tests that submit jobs.

``slurm`` is a fixture: it starts munged, slurmctld and slurmd as root, and leaves no process behind. Without its
programs, or not as root, its tests are skipped.
"""

import os
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from cluster import Cluster, daemons, free_ports

_PATH = f"{os.environ.get('PATH', '')}:/usr/sbin:/usr/bin"


class Slurm(Cluster):
    """A running Slurm."""

    def submit(self, directory: Path, *options: object) -> str:
        """Number of the job that ``job.sbatch`` of a directory became."""
        return self.call("sbatch", "--parsable", *options, "job.sbatch", cwd=directory).strip()

    def queue(self) -> list[str]:
        """Jobs and tasks that wait or run."""
        return self.call("squeue", "-h", "-r", "-o", "%i %t").splitlines()

    def end(self) -> None:
        """End all jobs."""
        self.call("scancel", "--me")
        self.wait()


@pytest.fixture(scope="session")
def slurm(executable: Callable[[str], Path]) -> Iterator[Slurm]:
    """Slurm with one idle node of two cores (or as many as there are)."""
    with daemons("slurm", ("munged", "slurmctld", "slurmd"), executable) as (home, start, wait):
        running = _started(home, start, wait)
        yield running
        running.end()


def _started(home: Path, start: Callable[..., None], wait: Callable[[Callable[[], bool]], None]) -> Slurm:
    for name in ("state", "spool", "munge"):
        (home / name).mkdir(mode=0o755)
    controller, node = free_ports(2)
    key = home / "munge" / "key"
    key.write_bytes(os.urandom(128))
    key.chmod(0o600)
    socket_path = home / "munge" / "socket"
    configuration = home / "slurm.conf"
    # new numbers of jobs: MPICH names its shared memory by them, and what was killed leaves some behind
    cores = min(2, os.cpu_count() or 1)
    configuration.write_text(f"""
ClusterName=granchain
SlurmctldHost={socket.gethostname()}(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={node}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={socket_path}
CredType=cred/munge
StateSaveLocation={home}/state
SlurmdSpoolDir={home}/spool
SlurmctldPidFile={home}/slurmctld.pid
SlurmdPidFile={home}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0,sched_min_interval=0
MpiDefault=pmi2
ReturnToService=2
KillWait=2
MinJobAge=10
FirstJobId={1 + time.time_ns() // 10**6 % 60_000_000}
InactiveLimit=0
NodeName={socket.gethostname()} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
""")
    environment = {**os.environ, "PATH": _PATH, "SLURM_CONF": str(configuration)}
    munge = home / "munge"
    start(
        environment,
        *("munged", "--foreground", f"--key-file={key}", f"--socket={socket_path}", f"--pid-file={munge}/pid"),
        *(f"--seed-file={munge}/seed", f"--log-file={munge}/log"),
    )
    wait(socket_path.exists)
    for daemon in ("slurmctld", "slurmd"):
        start(environment, daemon, "-D", "-c", "-f", configuration)
    running = Slurm(environment)

    def idle() -> bool:
        done = subprocess.run(["sinfo", "-h", "-o", "%t"], env=environment, capture_output=True, text=True)
        return done.stdout.strip() == "idle"

    wait(idle)
    return running
