"""The references that a run is compared with, or is: with ever more steps until their uncertainty is as asked for.

Also what accounts for the energy that the frames of a run have exchanged with what is outside, and with dashpots.
"""

import math
from collections.abc import Iterator

from lammps_inputs import Problem, physics
from workflow.engines.reference import engine
from workflow.engines.reference.accountant import Accountant
from workflow.engines.reference.certify import MOST_HALVINGS, Certifier
from workflow.prepare.settings import Settings
from workflow.runs.run_directory import RunDirectory

SURE = 1.0 / 3.0
"""Part of an accuracy to which the reference must be sure that tells whether a run keeps it."""

_MOST_DOUBLINGS = 4

CLOSED = 1e-9
"""Of the energy put in: what the budget of a run by the reference may miss."""

_MOST_STEPS = 256
"""In place of one usual step, for that."""


def certifiers(problem: Problem, settings: Settings | None) -> Iterator[Certifier]:
    """References of a problem, of which the last counts; each is asked how sure it is when its blocks were taken.

    With an accuracy in ever more steps, until the uncertainty is small enough or falls hardly more. Without one, or
    where nothing could be measured for the default, the usual reference.
    """
    if settings is None or (settings.measured == 0.0 and not settings.asked):
        yield Certifier(problem)
        return
    steps = 2 * math.ceil(0.5 * problem.every / settings.reference_timestep * (1.0 - 1e-9))
    before = math.inf
    for _ in range(_MOST_DOUBLINGS):
        certifier = Certifier(problem, steps_per_frame=steps)
        yield certifier
        sure = certifier.certificate.velocity
        if sure <= SURE * settings.accuracy or sure > 0.5 * before:
            return
        before, steps = sure, 2 * steps


def closing(problem: Problem) -> Iterator[Certifier]:
    """The usual reference; where energy is exchanged with ever more steps, until the budget is closed."""
    certifier = Certifier(problem)
    yield certifier
    usual = certifier.certificate.steps_per_frame
    while physics.exchanges(problem.system) and (missing := certifier.certificate.energy) > CLOSED:
        steps = certifier.certificate.steps_per_frame
        # contacts that open and close leave an order of 2.5
        steps = min(math.ceil(1.5 * steps * (missing / CLOSED) ** 0.4), _MOST_STEPS * usual)
        if steps <= certifier.certificate.steps_per_frame:
            return
        certifier = Certifier(problem, steps_per_frame=steps)
        yield certifier


def accountant(directory: RunDirectory, problem: Problem) -> Accountant:
    """Of the frames of a run, or of its snapshots, with the steps that the run itself took if it is the reference's.

    Args:
        directory: the run.
        problem: of the frames.
    """
    certificate = directory.account.certificate  # only the reference's runs have one
    if certificate is None or certificate.steps_per_frame is None:
        return Accountant(problem)
    most = 2**MOST_HALVINGS * engine.default_steps_per_frame(problem)
    return Accountant(problem, min(certificate.steps_per_frame, most))
