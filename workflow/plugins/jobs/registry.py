"""Schedulers by the name that users give them: those of granchain, and those that other distributions declare."""

from granchain.parts import plugins
from workflow.plugins.jobs import job_files, schedulers
from workflow.plugins.jobs.schedulers import Scheduler

SCHEDULERS: dict[str, Scheduler] = {**schedulers.OURS, **plugins.loaded("schedulers")}
"""Scheduler by name; ``granchain.schedulers`` is the group of entry points of other distributions."""

SCRIPTS = tuple(scheduler.script for scheduler in SCHEDULERS.values())
"""Names of the files that are submitted, a scheduler's each."""

JOB_FILES = (*SCRIPTS, *job_files.NAMES)
"""What any job has and leaves in the directory of a run, beside the run's own files."""
