"""Results of an analysis in sentences and tables, as `granchain analyze` prints them and a page shows them.

Plug-ins take this module for pages: `lines` are all sentences and tables of an analysis, `of_pulses` those of a survey.

Examples:
    >>> scene = granchain.load("one-chain", {"beads": 20, "duration": 30.0})
    >>> done = granchain.run(scene, tmp / "run", engine="reference")
    >>> [line for line in analysis_lines.lines(granchain.analyze(done)) if "energy input" in line][0]
    'the leading waves carry 99.4% of the energy input'
"""

from collections.abc import Iterator

import numpy as np

from analysis.sharing.survey import Survey
from analysis.tracking.undisturbed import CLEAR
from analysis.trajectory import along_the_way
from lammps_inputs import physics
from lammps_inputs.facts import Fact
from workflow.engines.lammps.worker import ENERGY_TOLERANCE
from workflow.screen import PrintedTable
from workflow.verdicts.analyse import Analysis
from workflow.verdicts.pulse_sentences import change_sentences, pulse_sentences
from workflow.verdicts.pulse_table import pulse_table

DOCUMENTED = 1e-4
"""Error of a peak velocity, in V, above which it is printed."""

FAR = 1.4
"""Time between frames, in T in contacts of strength 1, above which small maxima beside larger ones were missed."""


def lines(analysis: Analysis) -> Iterator[str | PrintedTable]:
    """Sentences and tables on the results of an analysis, in the order in which they are printed."""
    problem, conservation = analysis.problem, analysis.conservation
    if not analysis.complete:
        yield (
            f"the run is incomplete: {conservation.frames} of {problem.frames + 1} frames, to t = "
            f"{problem.scale.written(conservation.last_time, 'time')}; the existing frames were analysed"
        )
    if analysis.altered:
        yield "the checksum of the frames is not that in run.json: a file was damaged or modified"
    yield from _doubt(analysis)
    if problem.system.holds(Fact.PULSE):
        if (table := pulse_table(analysis.survey)) is not None:
            yield table
        yield from change_sentences(analysis.survey)
        yield from _accuracy(analysis)
    yield from pulse_sentences(analysis.survey)
    for measurement in analysis.measurements.values():
        yield from measurement.lines()
    yield from _drift(analysis)


def _drift(analysis: Analysis) -> Iterator[str]:
    """Lines on the drift of the energy, unless there is a budget of it, and of the momentum; or why there is none."""
    if missing := analysis.problem.rows.missing:
        yield f"energy and momentum are undefined: {missing}"
    exchanges = physics.exchanges(analysis.problem.system)
    shown = [
        f"{drift:.1e} of the {name} input"
        for name, drift in _drifts(analysis).items()
        if name != "energy" or not exchanges
    ]
    if shown:
        yield f"largest drift: {' and '.join(shown)}"


def _doubt(analysis: Analysis) -> Iterator[str]:
    """Lines on why the frames cannot be right where energy or momentum is not conserved."""
    drifts = _drifts(analysis)
    if max(drifts.values(), default=0.0) > ENERGY_TOLERANCE:
        name = max(drifts, key=lambda name: drifts[name])
        changes = f"the {name} changes by {drifts[name]:.2g} of the {name} input"
        cause = "these are not frames of this scene, or the time step is too large (see `granchain validate`)"
        yield analysis.failure or f"{changes}: {cause}"


def _drifts(analysis: Analysis) -> dict[str, float]:
    """Relative drifts of energy and momentum, by name, as far as they are known."""
    conservation = analysis.conservation
    drifts = {"energy": conservation.energy_drift, "momentum": conservation.momentum_drift}
    return {name: drift for name, drift in drifts.items() if np.isfinite(drift)}


UNCHECKED = "the run was not checked against the reference, so that uncertainties cover the time between frames alone"
"""What is printed of a run without a measured error."""


def of_pulses(survey: Survey) -> Iterator[str]:
    """Sentences on the succession of pulses, and on each of them."""
    yield from change_sentences(survey)
    yield from pulse_sentences(survey)


def _accuracy(analysis: Analysis) -> Iterator[str]:
    """Lines on what arrivals are, if not maxima, and the uncertainty of the table, if more than `DOCUMENTED`."""
    problem, waves = analysis.problem, analysis.survey.waves
    scale, clear = problem.scale, problem.beads - CLEAR
    before_last = waves.where(along_the_way(problem, waves.bead) < problem.beads)  # the last bead flies off
    if analysis.survey.arrival == "impulse":
        yield "the arrival of a wave is the centre of the impulse until the bead is fastest"
    elif free := int(np.count_nonzero(np.isnan(waves.arrival[along_the_way(problem, waves.bead) <= clear]))):
        where = f"{free} beads that fly" if free > 1 else "a bead that flies"
        yield (
            f"arrivals at the maximum of the velocity are undefined at {where} freely (empty in waves.csv); "
            "`--arrival impulse` defines them"
        )
    uncertainty = np.nan_to_num(before_last.peak_velocity_error)  # NaN where rigid beads follow rounding
    if uncertainty.max(initial=0.0) > DOCUMENTED:
        worst = int(np.argmax(uncertainty))
        late = before_last.arrival_error[np.isfinite(before_last.arrival_error)].max(initial=0.0)
        apart = scale.written(problem.every, "time", ".3g")
        arrivals = f", that of arrivals up to {scale.written(late, 'time', '.1e')}" if late > 0.0 else ""
        yield (
            f"the uncertainty of peak velocities, by frames {apart} apart and by the run, is up to "
            f"{uncertainty[worst]:.1e} V (bead {before_last.bead[worst]} of chain {before_last.chain[worst]})"
            f"{arrivals}; waves.csv has each"
        )
    if not analysis.error.measured:
        yield UNCHECKED
    far = FAR * physics.pulse_time(problem.system)
    if problem.every > far:
        apart = scale.written(far, "time", ".3g")
        yield f"frames are more than {apart} apart, so that small pulses between them may be missed"
