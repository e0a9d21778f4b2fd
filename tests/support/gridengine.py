"""A real Grid Engine of one node on this machine, from Debian's packages, for the tests that submit jobs.

``grid_engine`` is a fixture: it starts sge_qmaster and sge_execd as root, in a cell of its own, and leaves no process
behind. Without its programs, or not as root, its tests are skipped.
"""

import os
import socket
import subprocess
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import pytest
from cluster import Cluster, daemons, free_ports

PROGRAMS = Path("/usr/lib/gridengine")
SHARED = Path("/usr/share/gridengine")


class GridEngine(Cluster):
    """A running Grid Engine."""

    def submit(self, directory: Path, *options: object) -> str:
        """Number of the job that ``job.sge`` of a directory became."""
        return self.call("qsub", "-terse", *options, "job.sge", cwd=directory).strip().partition(".")[0]

    def queue(self) -> list[str]:
        """Jobs and tasks that wait or run."""
        return self.call("qstat", "-g", "d").splitlines()[2:]

    def end(self) -> None:
        """End all jobs."""
        if self.queue():
            self.call("qdel", "-f", "-u", "*")
        self.wait()


@pytest.fixture(scope="session")
def grid_engine(executable: Callable[[str], Path]) -> Iterator[GridEngine]:
    """Grid Engine with one idle node of two slots, and the parallel environments mpi and smp."""
    with daemons("grid-engine", ("sge_qmaster", "sge_execd", "qsub"), executable) as (home, start, wait):
        running = _started(home, start, wait)
        yield running
        running.end()


def _started(home: Path, start: Callable[..., None], wait: Callable[[Callable[[], bool]], None]) -> GridEngine:
    common, spool = home / "default" / "common", home / "spool"
    for directory in (common, spool, home / "jobs"):
        directory.mkdir(parents=True)
    (home / "util").symlink_to(SHARED / "util")
    architecture = subprocess.run([SHARED / "util" / "arch"], capture_output=True, text=True, check=True).stdout.strip()
    for name in ("bin", "lib", "utilbin"):
        (home / name).mkdir()
        (home / name / architecture).symlink_to(PROGRAMS)
    # both daemons are on 127.0.0.1, whose first name is localhost, whatever this machine is called
    (common / "act_qmaster").write_text("localhost\n")
    (common / "host_aliases").write_text(f"localhost {socket.gethostname()}\n")
    _write(
        common / "bootstrap",
        {
            **{"admin_user": "none", "default_domain": "none", "ignore_fqdn": "false", "security_mode": "none"},
            **{"spooling_method": "classic", "spooling_lib": "libspoolc", "spooling_params": f"{common};{spool}"},
            **{"binary_path": PROGRAMS, "qmaster_spool_dir": spool},
            **{"listener_threads": 1, "worker_threads": 1, "scheduler_threads": 1},
        },
    )
    master, node = free_ports(2)
    running = GridEngine(
        {
            **{name: value for name, value in os.environ.items() if not name.startswith("SGE_")},
            **{"PATH": f"{PROGRAMS}:{os.environ.get('PATH', '')}", "SGE_ROOT": str(home), "SGE_CELL": "default"},
            **{"SGE_QMASTER_PORT": str(master), "SGE_EXECD_PORT": str(node), "SGE_ARCH": architecture},
        }
    )
    standard = _read(SHARED / "default-configuration")
    _write(
        home / "configuration",
        {**standard, "execd_spool_dir": home / "jobs", "min_uid": 0, "min_gid": 0, "load_report_time": "0:0:1"},
    )
    running.call("spoolinit", "classic", "libspoolc", f"{common};{spool}", "init")
    running.call("spooldefaults", "configuration", home / "configuration")
    for kind, folder in (("complexes", "centry"), ("usersets", "usersets")):
        running.call("spooldefaults", kind, SHARED / "util" / "resources" / folder)
    running.call("spooldefaults", "managers", "root")

    in_foreground = {**running.environment, "SGE_ND": "1"}

    def answers(*words: str) -> bool:
        done = subprocess.run([PROGRAMS / words[0], *words[1:]], env=running.environment, capture_output=True)
        return done.returncode == 0

    start(in_foreground, PROGRAMS / "sge_qmaster")
    wait(lambda: answers("qconf", "-as", "localhost"))
    _configure(running, home)
    start(in_foreground, PROGRAMS / "sge_execd")

    def idle() -> bool:
        return running.call("qstat", "-f").count("/0/2 ") == 1 and "lx-" in running.call("qstat", "-f")

    wait(idle)
    return running


def _configure(running: GridEngine, home: Path) -> None:
    """Add the node, its queue and the parallel environments, and let jobs start at once."""

    def put(option: str, settings: Mapping[str, object]) -> None:
        _write(home / "settings", settings)
        running.call("qconf", option, home / "settings")

    names = ("complex_values", "user_lists", "xuser_lists", "projects", "xprojects", "usage_scaling")
    put("-Ae", {"hostname": "localhost", **dict.fromkeys((*names, "load_scaling", "report_variables"), "NONE")})
    environment = _read(SHARED / "util" / "resources" / "pe" / "mpi")
    for name, rule in (("mpi", "$fill_up"), ("smp", "$pe_slots")):
        put("-Ap", {**environment, "pe_name": name, "allocation_rule": rule, "control_slaves": "FALSE"})
    queue = {"qname": "all.q", "hostlist": "localhost", "slots": 2, "load_thresholds": "NONE", "pe_list": "mpi smp"}
    put("-Aq", {**_settings(running.call("qconf", "-sq")), **queue})
    at_once = {"schedule_interval": "0:0:1", "flush_submit_sec": 1, "flush_finish_sec": 1}
    put("-Msconf", {**_settings(running.call("qconf", "-ssconf")), **at_once})


def _settings(text: str) -> dict[str, str]:
    """Settings in a text with one name and value a line."""
    lines = (line.split(None, 1) for line in text.splitlines() if line.strip() and not line.startswith("#"))
    return {name: value.strip() for name, value in lines}


def _read(path: Path) -> dict[str, str]:
    return _settings(path.read_text())


def _write(path: Path, settings: Mapping[str, object]) -> None:
    path.write_text("".join(f"{name} {value}\n" for name, value in settings.items()))
