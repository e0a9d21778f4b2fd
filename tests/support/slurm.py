"""A real Slurm of one node on this machine, from Debian's packages, for the tests that submit jobs.

``slurm`` is a fixture: it starts munged, slurmctld and slurmd as root, and leaves no process behind. Without its
programs, or not as root, its tests are skipped.
"""

import os
import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from cluster import Cluster, as_root, free_ports, stop
from processes import wait_until

DAEMONS = ("munged", "slurmctld", "slurmd")
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
    for name in DAEMONS:
        executable(name)
    as_root("Slurm")
    home = Path("/run") / f"granchain-slurm-{os.getpid()}"  # sockets have short paths, and munge wants safe parents
    home.mkdir(mode=0o755)
    processes: list[subprocess.Popen[bytes]] = []
    try:
        running = _start(home, processes)
        yield running
        running.end()
    finally:
        stop(processes)
        shutil.rmtree(home, ignore_errors=True)


def _start(home: Path, processes: list["subprocess.Popen[bytes]"]) -> Slurm:
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
    log = (home / "log").open("wb")

    def start(*words: object) -> None:
        processes.append(
            subprocess.Popen(
                [str(word) for word in words], env=environment, stdin=subprocess.DEVNULL, stdout=log, stderr=log
            )
        )

    munge = home / "munge"
    start(
        *("munged", "--foreground", f"--key-file={key}", f"--socket={socket_path}", f"--pid-file={munge}/pid"),
        *(f"--seed-file={munge}/seed", f"--log-file={munge}/log"),
    )
    assert wait_until(socket_path.exists), (home / "log").read_text()
    start("slurmctld", "-D", "-c", "-f", configuration)
    start("slurmd", "-D", "-c", "-f", configuration)
    log.close()
    running = Slurm(environment)

    def idle() -> bool:
        done = subprocess.run(["sinfo", "-h", "-o", "%t"], env=environment, capture_output=True, text=True)
        return done.stdout.strip() == "idle"

    assert wait_until(idle), (home / "log").read_text()[-3000:]
    return running
