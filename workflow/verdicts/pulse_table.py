"""Table of the leading pulse at selected beads, as `granchain analyze` prints it and a notebook shows it."""

import numpy as np

from analysis.quantity import cell, headings
from analysis.sharing.survey import Survey
from analysis.tracking.leading_waves import Waves
from analysis.tracking.pulses import of_one_kind
from analysis.trajectory import Integers, along_the_way
from lammps_inputs import physics
from lammps_inputs.facts import Fact
from workflow.measures.measurement import MOST_CHAINS
from workflow.screen import PrintedTable

MOST_BEADS = 7
"""Largest number of beads in the table."""

MOST_ROWS = 32
"""Largest number of rows in the table; with many chains it has fewer beads."""

_COLUMNS = {"arrival": "arrival", "peak_velocity": "peak velocity", "speed": "speed"}


def pulse_table(survey: Survey) -> PrintedTable | None:
    """Arrival, peak velocity and speed of the leading waves at selected beads; None where no pulse leads.

    Numbers are in the scene's units, in SI with the peak velocity over V beside them. The last bead is the last one
    that a pulse passed clear of the end of the chain.
    """
    if not survey.problem.system.holds(Fact.PULSE):
        return None
    scale = survey.problem.scale
    head = ["bead", "chain", *headings(Waves, scale, _COLUMNS), *(["peak velocity / V"] if scale.si else [])]
    rows = [row for bead in selected_beads(survey) for row in _rows(survey.waves.at(bead), bead, survey)]
    return PrintedTable("leading pulse", head, rows) if rows else None


def _rows(waves: Waves, bead: int, survey: Survey) -> list[list[str]]:
    """Rows of one bead, one for each of the first chains; a last one says of how many chains."""
    scale, measured = survey.problem.scale, waves.measured(survey.problem.scale)
    rows = []
    for k in range(min(len(waves), MOST_CHAINS)):
        numbers = [cell(getattr(measured, name)[k], ".7g" if name == "arrival" else ".5g") for name in _COLUMNS]
        row = [str(bead) if k == 0 else "", str(waves.chain[k]), *numbers]
        rows.append([*row, f"{waves.peak_velocity[k]:.5f}"] if scale.si else row)
    if len(waves) > MOST_CHAINS:
        rows.append(["", f"of {len(waves)}", "", "", "", *([""] if scale.si else [])])
    return rows


def selected_beads(survey: Survey) -> list[int]:
    """Numbers of at most `MOST_BEADS` beads, from the kicked bead to the last that a pulse passed clear of the end.

    They are beads of one kind where beads differ, as amplitudes of unlike beads are not comparable.
    """
    problem, waves = survey.problem, survey.waves
    if len(waves) == 0:
        return []
    passed = _passed(survey)
    if len(passed) == 0:
        return []
    last = int(along_the_way(problem, waves.bead)[survey.last_clear_bead(waves)])
    count = max(2, min(MOST_BEADS, MOST_ROWS // min(problem.chains, MOST_CHAINS)))
    places = [2, 5, 10, 20, 55, 90, last] if last <= 200 else np.geomspace(5, last, 7).round().astype(int).tolist()
    chosen = [places[k] for k in np.linspace(0, len(places) - 1, count).round().astype(int)]
    nearest = {int(passed[np.argmin(np.abs(passed - bead))]) for bead in chosen if bead <= last}
    return [along_the_way(problem, bead) for bead in sorted(nearest)]


def _passed(survey: Survey) -> Integers:
    """Beads of one kind that a pulse passed, counted along its way, from the first kicked bead on."""
    problem = survey.problem
    beads = np.unique(survey.waves.bead)
    alike = beads[of_one_kind(problem)[beads - 1]]
    passed = along_the_way(problem, alike if len(alike) else beads)
    kicked_beads = [
        along_the_way(problem, kicked_bead)
        for _, kicked_bead, impulse in physics.excitations(problem.system)
        if impulse * survey.direction > 0.0
    ]
    return passed[passed >= min(kicked_beads)]  # first maxima of the beads behind are those of rebounds
