"""Names of the files that a run is given and leaves: of the deck, of what continues from a restart, and of a job.

Imports nothing: who only looks at directories need not load what a scene may be.
"""

SCENE = "scene.yaml"

DECK = "in.chains"
DATA = "data.chains"
TABLES = "in.tables"
"""Long tables of forces over time, which the deck includes."""
DUMP = "chains.dump.bin"
SNAPSHOTS = "chains.snapshots.bin"
LOG = "log.lammps"

CONTINUE = "in.continue"
RESTART = "chains.restart"
RESTART_SUMS = "chains.restart.sha256"
UNFINISHED = "chains.restart.part"
"""A restart while it is written."""

CASES = "cases.txt"
JOB = "job.sbatch"
JOB_OF_PBS = "job.pbs"
JOB_OF_GRID_ENGINE = "job.sge"
JOBS = (JOB, JOB_OF_PBS, JOB_OF_GRID_ENGINE)
"""A job's script, by its scheduler."""
JOB_INPUT = "in.job"
JOB_STATE = "job.state"
JOB_FLAG = "job.flag"
JOB_FRAMES = "job.frames"
JOB_OUTPUT = "job.out"
JOB_FILES = (
    *(*JOBS, JOB_INPUT, JOB_STATE, JOB_FLAG, "job.room"),
    *(JOB_FRAMES, f"{JOB_FRAMES}.part", JOB_OUTPUT),
)
"""What a job has and leaves in the directory of a run, beside the run's own files."""
