"""Names of the files that a job has and leaves in the directory of a run, beside the run's own; see `job`."""

INPUT = "in.job"
STATE = "job.state"
FLAG = "job.flag"
FRAMES = "job.frames"
OUTPUT = "job.out"

NAMES = (INPUT, STATE, FLAG, "job.room", FRAMES, f"{FRAMES}.part", OUTPUT)
"""All of them but scripts, whose names are those of `schedulers.Scheduler.script`."""
